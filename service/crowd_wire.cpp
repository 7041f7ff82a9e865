#include "service/crowd_wire.h"

#include <fmt/format.h>

#include <cmath>
#include <cstring>
#include <type_traits>

namespace forewalk::service {
namespace {

using agents::NetworkCommand;
using agents::NetworkSnapshot;
using agents::NetworkWelcome;
using agents::Wall;

constexpr std::uint32_t kVersion = 0x316e7766;  // "fwn1"

Error damaged(std::string sentence) {
  return {ErrorCode::kDataDamaged, "crowd message: " + std::move(sentence)};
}

// One walk over the fields of every message serves writing and reading.
class Writer {
 public:
  static constexpr bool kReads = false;
  explicit Writer(std::vector<std::byte>& bytes) : bytes_(bytes) {}

  template <typename T>
  void number(const T& value) {
    using Bits =
        std::conditional_t<sizeof(T) == 1, std::uint8_t,
                           std::conditional_t<sizeof(T) == 4, std::uint32_t, std::uint64_t>>;
    static_assert(sizeof(Bits) == sizeof(T));
    Bits bits;
    std::memcpy(&bits, &value, sizeof bits);
    for (std::size_t k = 0; k < sizeof bits; ++k) {
      bytes_.push_back(static_cast<std::byte>(bits >> (8 * k)));
    }
  }
  template <typename T, typename Visit>
  void list(const std::vector<T>& items, std::size_t, const Visit& visit) {
    number(static_cast<std::uint32_t>(items.size()));
    for (const T& item : items) visit(item);
  }
  void endless(const float& value) { number(value); }

 private:
  std::vector<std::byte>& bytes_;
};

class Reader {
 public:
  static constexpr bool kReads = true;
  explicit Reader(std::span<const std::byte> bytes) : bytes_(bytes) {}

  template <typename T>
  void number(T& value) {
    read(value);
    if constexpr (std::is_floating_point_v<T>) {
      if (!std::isfinite(value)) fail("a number is not finite");
    }
  }
  /// A float that may be infinite.
  void endless(float& value) {
    read(value);
    if (std::isnan(value)) fail("a number is not finite");
  }
  /// `least`: bytes that an item takes at least, so that a count is no more than can follow.
  template <typename T, typename Visit>
  void list(std::vector<T>& items, std::size_t least, const Visit& visit) {
    std::uint32_t count = 0;
    number(count);
    if (count > (bytes_.size() - at_) / least) {
      fail(fmt::format("{} items are announced, {} bytes are left", count, bytes_.size() - at_));
      return;
    }
    items.resize(count);
    for (T& item : items) visit(item);
  }
  void fail(std::string sentence) {
    if (fault_.empty()) fault_ = std::move(sentence);
  }
  const std::string& fault() const { return fault_; }
  std::size_t left() const { return bytes_.size() - at_; }

 private:
  template <typename T>
  void read(T& value) {
    using Bits =
        std::conditional_t<sizeof(T) == 1, std::uint8_t,
                           std::conditional_t<sizeof(T) == 4, std::uint32_t, std::uint64_t>>;
    Bits bits = 0;
    if (left() < sizeof bits) {
      at_ = bytes_.size();
      fail(fmt::format("it ends after {} bytes, in the middle of a number", bytes_.size()));
    } else {
      for (std::size_t k = 0; k < sizeof bits; ++k) {
        bits = static_cast<Bits>(bits |
                                 static_cast<Bits>(static_cast<Bits>(bytes_[at_ + k]) << (8 * k)));
      }
      at_ += sizeof bits;
    }
    std::memcpy(&value, &bits, sizeof bits);
  }
  std::span<const std::byte> bytes_;
  std::size_t at_ = 0;
  std::string fault_;
};

template <typename Io, typename V>
void point(Io& io, V& value) {
  io.number(value.x);
  io.number(value.y);
}

template <typename Io, typename V>
void fields(Io& io, V& message) requires(std::is_same_v<std::remove_const_t<V>, NetworkWelcome>) {
  std::uint32_t version = kVersion;
  io.number(version);
  io.number(message.client);
  io.number(message.seconds);
  std::uint8_t flags =
      static_cast<std::uint8_t>((message.velocityBias ? 1 : 0) | (message.deadReckoning ? 2 : 0));
  io.number(flags);
  if constexpr (Io::kReads) {
    if (!(message.seconds > 0.0f && message.seconds <= 10.0f)) {
      io.fail(fmt::format("a tick of {} s; it has to be above 0 and at most 10", message.seconds));
    }
    if (flags > 3) io.fail(fmt::format("flags are {}, 3 is the most", flags));
    message.velocityBias = flags & 1;
    message.deadReckoning = flags & 2;
  }
  io.list(message.members, 41, [&](auto& member) {
    io.number(member.client);
    io.number(member.group);
    io.number(member.flags);
    point(io, member.position);
    point(io, member.velocity);
    io.number(member.heading);
    io.number(member.radius);
    io.number(member.preferredSpeed);
    io.number(member.maximumSpeed);
  });
  io.list(message.walls, 52, [&](auto& wall) {
    point(io, wall.from);
    point(io, wall.to);
    io.number(wall.previous);
    io.number(wall.next);
    io.number(wall.clearance);
    io.number(wall.fromHeight);
    io.number(wall.toHeight);
    io.endless(wall.reach);
    point(io, wall.velocity);
    io.number(wall.attraction);
  });
  if constexpr (Io::kReads) {
    if (version != kVersion) {
      io.fail(fmt::format("version {:08x}, this program speaks {:08x}", version, kVersion));
    }
    for (const Wall& wall : message.walls) {
      const auto isHere = [&](std::uint32_t other) {
        return other == agents::kNoWall || other < message.walls.size();
      };
      if (!isHere(wall.previous) || !isHere(wall.next)) io.fail("a wall is linked to none");
    }
  }
}

template <typename Io, typename V>
void fields(Io& io, V& message) requires(std::is_same_v<std::remove_const_t<V>, NetworkSnapshot>) {
  io.number(message.tick);
  io.number(message.answered);
  io.list(message.states, 24, [&](auto& state) {
    io.number(state.agent);
    point(io, state.position);
    point(io, state.velocity);
    io.number(state.heading);
  });
  io.list(message.ways, 44, [&](auto& way) {
    io.number(way.agent);
    io.number(way.count);
    for (auto& corner : way.corners) point(io, corner);
    io.number(way.beyond);
    if constexpr (Io::kReads) {
      if (way.count > NetworkSnapshot::Way::kCorners) {
        io.fail(fmt::format("a way has {} corners, {} are the most", way.count,
                            NetworkSnapshot::Way::kCorners));
      }
    }
  });
}

template <typename Io, typename V>
void fields(Io& io, V& message) requires(std::is_same_v<std::remove_const_t<V>, NetworkCommand>) {
  io.number(message.number);
  io.list(message.motions, 16, [&](auto& motion) {
    io.number(motion.agent);
    point(io, motion.velocity);
    io.number(motion.heading);
  });
}

template <typename Io, typename V>
void fields(Io&, V&) requires(std::is_empty_v<V>) {}

template <typename Message>
tl::expected<NetworkMessage, Error> read(std::span<const std::byte> rest) {
  Message message;
  Reader reader(rest);
  fields(reader, message);
  if (reader.left() > 0) reader.fail(fmt::format("{} bytes are left over", reader.left()));
  if (reader.fault().empty()) return message;
  Error error = damaged(reader.fault() + ".");
  if (reader.fault().starts_with("version")) error.code = ErrorCode::kFormatUnsupported;
  return tl::unexpected(std::move(error));
}

}  // namespace

void encode(const NetworkMessage& message, std::vector<std::byte>& bytes) {
  bytes.assign(4, std::byte{0});
  Writer writer(bytes);
  writer.number(static_cast<std::uint8_t>(message.index() + 1));
  std::visit([&](const auto& value) { fields(writer, value); }, message);
  const auto length = static_cast<std::uint32_t>(bytes.size() - 4);
  for (std::size_t k = 0; k < 4; ++k) bytes[k] = static_cast<std::byte>(length >> (8 * k));
}

tl::expected<NetworkMessage, Error> decode(std::span<const std::byte> payload) {
  if (payload.empty()) return tl::unexpected(damaged("it is empty."));
  const auto rest = payload.subspan(1);
  switch (static_cast<std::uint8_t>(payload[0])) {
    case 1:
      return read<NetworkWelcome>(rest);
    case 2:
      return read<NetworkSnapshot>(rest);
    case 3:
      return read<NetworkTick>(rest);
    case 4:
      return read<NetworkCommand>(rest);
    case 5:
      return read<NetworkBye>(rest);
    default:
      return tl::unexpected(damaged(
          fmt::format("it is of kind {}; 1 to 5 are known.", static_cast<unsigned>(payload[0]))));
  }
}

tl::expected<std::uint32_t, Error> payloadLength(std::span<const std::byte, 4> bytes) {
  std::uint32_t length = 0;
  for (std::size_t k = 0; k < 4; ++k) {
    length |= static_cast<std::uint32_t>(bytes[k]) << (8 * k);
  }
  if (length == 0 || length > kLongestMessage) {
    return tl::unexpected(damaged(
        fmt::format("its length is {} bytes; it has to be 1 to {}.", length, kLongestMessage)));
  }
  return length;
}

}  // namespace forewalk::service
