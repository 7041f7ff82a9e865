#include "service/daemon/state_token.h"

#include <fmt/format.h>
#include <openssl/crypto.h>
#include <openssl/evp.h>
#include <openssl/params.h>
#include <openssl/rand.h>
#include <openssl/sha.h>

#include <limits>
#include <stdexcept>
#include <utility>

namespace forewalk::daemon {
namespace {

constexpr std::size_t kMacBytes = 16;
constexpr std::size_t kDigestBytes = 32;
static_assert(kTokenBytes == kStateBytes + kMacBytes);

tl::unexpected<Error> refuse(std::string message, ErrorCode code = ErrorCode::kDataDamaged) {
  return tl::unexpected(Error{code, std::move(message)});
}

void require(bool works) {
  if (!works) throw std::runtime_error("the cryptography library (OpenSSL) does not work");
}

}  // namespace

struct TokenSigner::Mac {
  explicit Mac(std::string_view key) {
    const char* digest = "SHA256";
    const OSSL_PARAM parameters[] = {
        OSSL_PARAM_construct_utf8_string("digest", const_cast<char*>(digest), 0),
        OSSL_PARAM_construct_end()};
    require(algorithm != nullptr && context != nullptr);
    require(EVP_MAC_init(context, reinterpret_cast<const unsigned char*>(key.data()), key.size(),
                         parameters) == 1);
  }
  Mac(const Mac&) = delete;
  Mac& operator=(const Mac&) = delete;
  ~Mac() {
    EVP_MAC_CTX_free(context);
    EVP_MAC_free(algorithm);
  }

  /// Over the first kStateBytes of `bytes`.
  void of(const char* bytes, unsigned char (&mac)[kDigestBytes]) {
    std::size_t size = 0;
    // Without a key: again with the one before, which is worked in already.
    require(EVP_MAC_init(context, nullptr, 0, nullptr) == 1);
    require(EVP_MAC_update(context, reinterpret_cast<const unsigned char*>(bytes), kStateBytes) ==
            1);
    require(EVP_MAC_final(context, mac, &size, kDigestBytes) == 1 && size == kDigestBytes);
  }

  EVP_MAC* algorithm = EVP_MAC_fetch(nullptr, "HMAC", nullptr);
  EVP_MAC_CTX* context = EVP_MAC_CTX_new(algorithm);
};

TokenSigner::TokenSigner(std::string_view key, const NavMeshHash& navMesh)
    : mac_(std::make_unique<Mac>(key)), navMesh_(navMesh) {}
TokenSigner::TokenSigner(TokenSigner&&) noexcept = default;
TokenSigner::~TokenSigner() = default;

void TokenSigner::sign(const TokenState& state, std::string& token) {
  putStateBytes(state, navMesh_, token);
  unsigned char mac[kDigestBytes];
  mac_->of(token.data(), mac);
  token.append(reinterpret_cast<const char*>(mac), kMacBytes);
}

tl::expected<TokenState, Error> TokenSigner::open(std::string_view token) {
  if (token.size() != kTokenBytes) {
    return refuse(fmt::format("token: {} bytes; a token has {}. Begin without one.", token.size(),
                              kTokenBytes));
  }
  unsigned char mac[kDigestBytes];
  mac_->of(token.data(), mac);
  if (CRYPTO_memcmp(mac, token.data() + kStateBytes, kMacBytes) != 0) {
    return refuse(
        "token: not signed with this daemon's key. Give daemons that share sessions one key "
        "(--key-file), or begin without a token.");
  }
  return stateFromBytes(token.substr(0, kStateBytes), navMesh_);
}

std::string randomBytes(std::size_t count) {
  std::string bytes(count, '\0');
  require(RAND_bytes(reinterpret_cast<unsigned char*>(bytes.data()), static_cast<int>(count)) == 1);
  return bytes;
}

bool equalInConstantTime(std::string_view given, std::string_view secret) {
  const auto digestOf = [](std::string_view text, unsigned char* digest) {
    SHA256(reinterpret_cast<const unsigned char*>(text.data()), text.size(), digest);
  };
  unsigned char a[SHA256_DIGEST_LENGTH], b[SHA256_DIGEST_LENGTH];
  digestOf(given, a);
  digestOf(secret, b);
  return CRYPTO_memcmp(a, b, sizeof a) == 0;
}

}  // namespace forewalk::daemon
