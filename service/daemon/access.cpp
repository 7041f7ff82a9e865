#include "service/daemon/access.h"

#include <fmt/format.h>

#include <algorithm>
#include <boost/asio/ip/address.hpp>
#include <cctype>
#include <cstdlib>

#include "navmesh/file_text.h"
#include "service/daemon/state_token.h"
#include "service/files.h"

namespace forewalk::daemon {
namespace {

constexpr std::size_t kLeastToken = 16;

tl::unexpected<Error> refuse(std::string message) {
  return tl::unexpected(Error{ErrorCode::kSettingOutOfRange, std::move(message)});
}

// Those that go into a header, a subprotocol and a URL as they are.
bool isTokenLetter(char c) {
  return std::isalnum(static_cast<unsigned char>(c)) != 0 ||
         std::string_view("-._~").find(c) != std::string_view::npos;
}

bool isOrigin(std::string_view text) {
  const std::size_t scheme = text.find("://");
  if (scheme == 0 || scheme == std::string_view::npos) return false;
  const std::string_view host = text.substr(scheme + 3);
  return !host.empty() && host.find('/') == std::string_view::npos &&
         std::all_of(text.begin(), text.end(), [](char c) { return c > ' ' && c < 127; });
}

/// Calls visit(name) for each of a header's list "a, b,c".
template <typename Visit>
void forEachListed(std::string_view list, const Visit& visit) {
  while (!list.empty()) {
    std::string_view name = list.substr(0, list.find(','));
    list.remove_prefix(std::min(list.size(), name.size() + 1));
    while (!name.empty() && (name.front() == ' ' || name.front() == '\t')) name.remove_prefix(1);
    while (!name.empty() && (name.back() == ' ' || name.back() == '\t')) name.remove_suffix(1);
    visit(name);
  }
}

bool isLoopback(const Access& access) {
  boost::system::error_code failure;
  const auto address = boost::asio::ip::make_address(access.address, failure);
  return !failure && address.is_loopback();
}

}  // namespace

tl::expected<void, Error> validate(const Access& access) {
  boost::system::error_code failure;
  boost::asio::ip::make_address(access.address, failure);
  if (failure) {
    return refuse(
        fmt::format("--listen {}: no IP address. Give 127.0.0.1 (only this machine) or, "
                    "with a token, 0.0.0.0.",
                    inQuotes(access.address)));
  }
  if (!access.token.empty() &&
      (access.token.size() < kLeastToken ||
       !std::all_of(access.token.begin(), access.token.end(), isTokenLetter))) {
    return refuse(
        fmt::format("access token: {} characters; give at least {}, letters, digits and "
                    "-._~ only, for example from: openssl rand -hex 24",
                    access.token.size(), kLeastToken));
  }
  if (access.token.empty() && !isLoopback(access)) {
    return refuse(
        fmt::format("--listen {}: reaches beyond this machine, and no access token is set. "
                    "Give one by --token-file FILE or in FOREWALK_TOKEN.",
                    access.address));
  }
  for (const std::string& origin : access.origins) {
    if (!isOrigin(origin)) {
      return refuse(
          fmt::format("--origin {}: give scheme://host or scheme://host:port, for example "
                      "https://lab.example.org",
                      inQuotes(origin)));
    }
  }
  return {};
}

bool originAllowed(const Access& access, const std::optional<std::string>& origin) {
  if (!origin) return true;
  if (std::find(access.origins.begin(), access.origins.end(), *origin) != access.origins.end())
    return true;
  if (!isLoopback(access)) return false;
  for (const std::string_view host : {"localhost", "127.0.0.1", "[::1]"}) {
    if (*origin == fmt::format("http://{}:{}", host, access.port)) return true;
  }
  return false;
}

bool tokenGiven(const Access& access, std::string_view authorization,
                std::string_view subprotocols) {
  if (access.token.empty()) return true;
  constexpr std::string_view kBearer = "Bearer ", kInList = "token.";
  if (authorization.substr(0, kBearer.size()) == kBearer &&
      equalInConstantTime(authorization.substr(kBearer.size()), access.token)) {
    return true;
  }
  bool given = false;
  forEachListed(subprotocols, [&](std::string_view name) {
    if (name.substr(0, kInList.size()) != kInList) return;
    given = equalInConstantTime(name.substr(kInList.size()), access.token) || given;
  });
  return given;
}

bool offers(std::string_view subprotocols, std::string_view name) {
  bool offered = false;
  forEachListed(subprotocols,
                [&](std::string_view listed) { offered = offered || listed == name; });
  return offered;
}

tl::expected<std::string, Error> secretFrom(const std::filesystem::path& file,
                                            const char* variable) {
  if (file.empty()) {
    const char* value = std::getenv(variable);
    return std::string(value == nullptr ? "" : value);
  }
  const auto bytes = service::readFile(file);
  if (!bytes) return tl::unexpected(bytes.error());
  Lines lines({reinterpret_cast<const char*>(bytes->data()), bytes->size()});
  std::string_view line;
  if (!lines.next(line) || line.empty()) {
    return tl::unexpected(
        Error{ErrorCode::kDataDamaged,
              fmt::format("{}: its first line is empty; it has to be the secret.", file.string())});
  }
  return std::string(line);
}

}  // namespace forewalk::daemon
