// A networked crowd in processes: the same as in one, and refused clearly where it goes wrong.
#include "service/crowd_network.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <thread>

#include "agents/published_scenes.h"
#include "service/crowd_wire.h"

namespace forewalk::service {
namespace {

using agents::NetworkMetrics;
using agents::NetworkSettings;
using ::testing::HasSubstr;

NetworkSettings late() {
  NetworkSettings settings;
  settings.delay = 0.1f;
  settings.loss = 0.05f;
  return settings;
}

TEST(CrowdWire, BringsBackWhatWasSent) {
  auto server = agents::NetworkServer::make(agents::cityBlockScene(2), late());
  ASSERT_TRUE(server);
  agents::NetworkClient client(server->welcome(0));
  for (int tick = 0; tick < 3; ++tick) {
    server->step();
    client.receive(server->snapshot(0));
    server->receive(0, client.step());
  }
  for (const NetworkMessage& message :
       {NetworkMessage(server->welcome(1)), NetworkMessage(server->snapshot(0)),
        NetworkMessage(client.step()), NetworkMessage(NetworkTick{}),
        NetworkMessage(NetworkBye{})}) {
    std::vector<std::byte> bytes, again;
    encode(message, bytes);
    const auto length = payloadLength(std::span<const std::byte, 4>(bytes.data(), 4));
    ASSERT_TRUE(length);
    ASSERT_EQ(*length + 4, bytes.size());
    const auto back = decode(std::span(bytes).subspan(4));
    ASSERT_TRUE(back) << back.error().message;
    // Every field is a number of its own, so equal bytes are equal fields.
    encode(*back, again);
    EXPECT_EQ(bytes, again);
    if (const auto* snapshot = std::get_if<agents::NetworkSnapshot>(&message)) {
      EXPECT_TRUE(std::get<agents::NetworkSnapshot>(*back) == *snapshot);
    }
    if (const auto* command = std::get_if<agents::NetworkCommand>(&message)) {
      EXPECT_TRUE(std::get<agents::NetworkCommand>(*back) == *command);
    }
  }
}

TEST(CrowdWire, RefusesWhatIsCutOrTooMuch) {
  auto server = agents::NetworkServer::make(agents::circleScene(4), {});
  std::vector<std::byte> bytes;
  encode(server->welcome(0), bytes);
  for (std::size_t length = 0; length + 4 < bytes.size(); ++length) {
    EXPECT_FALSE(decode(std::span(bytes).subspan(4, length))) << length;
  }
  bytes.push_back(std::byte{0});
  EXPECT_THAT(decode(std::span(bytes).subspan(4)).error().message, HasSubstr("left over"));
  const std::byte endless[4] = {std::byte{0xff}, std::byte{0xff}, std::byte{0xff}, std::byte{0xff}};
  EXPECT_THAT(payloadLength(endless).error().message, HasSubstr("4294967295 bytes"));
  // A count far beyond what follows is refused before room is made for it.
  const std::byte many[] = {std::byte{4},   std::byte{1},    std::byte{0},    std::byte{0},
                            std::byte{0},   std::byte{0},    std::byte{0},    std::byte{0},
                            std::byte{0},   std::byte{0xff}, std::byte{0xff}, std::byte{0xff},
                            std::byte{0xff}};
  EXPECT_THAT(decode(many).error().message, HasSubstr("items are announced, 0 bytes are left"));
}

TEST(CrowdNetwork, OverSocketsIsTheRunWithoutToTheLastBit) {
  const agents::CrowdScene scene = agents::meetingScene(10, 6.0f, 4);
  const auto inOne = agents::runNetwork(scene, late(), 5.0);
  ASSERT_TRUE(inOne);
  NetworkHost host;
  std::vector<std::thread> clients;
  std::vector<tl::expected<void, Error>> ends(2);
  host.listening = [&](std::uint16_t port) -> tl::expected<void, Error> {
    for (std::size_t c = 0; c < 2; ++c) {
      clients.emplace_back([&ends, c, port] { ends[c] = joinNetwork("127.0.0.1", port); });
    }
    return {};
  };
  const auto served = serveNetwork(scene, late(), 5.0, host);
  for (std::thread& client : clients) client.join();
  ASSERT_TRUE(served) << served.error().message;
  EXPECT_TRUE(ends[0] && ends[1]);
  EXPECT_EQ(served->hash, inOne->hash);
}

TEST(CrowdNetwork, InProcessesIsTheRunInOneToTheLastBit) {
  const agents::CrowdScene scene = agents::cityBlockScene(4);
  for (const std::uint32_t clients : {1u, 2u, 3u}) {
    NetworkSettings settings = late();
    settings.clients = clients;
    settings.cells = agents::cityBlockCells();
    const auto inOne = agents::runNetwork(scene, settings, 5.0);
    const auto inMany = runNetworkInProcesses(scene, settings, 5.0, FOREWALK_PROGRAM);
    ASSERT_TRUE(inOne && inMany) << inMany.error().message;
    EXPECT_EQ(inMany->hash, inOne->hash) << clients << " clients";
    EXPECT_EQ(inMany->collisions, inOne->collisions);
  }
}

TEST(CrowdNetwork, SaysWhoDidNotComeAndWhoLeft) {
  const agents::CrowdScene scene = agents::circleScene(4);
  NetworkHost host;
  host.patience = 0.2;
  const auto alone = serveNetwork(scene, {}, 5.0, host);
  ASSERT_FALSE(alone);
  EXPECT_THAT(alone.error().message, HasSubstr("0 of 2 crowd clients came to 127.0.0.1:"));
  const auto noProgram = runNetworkInProcesses(scene, {}, 5.0, "/bin/true", 0.5);
  ASSERT_FALSE(noProgram);
  const auto nobody = joinNetwork("127.0.0.1", 1);
  ASSERT_FALSE(nobody);
  EXPECT_THAT(nobody.error().message, HasSubstr("no crowd server at 127.0.0.1:1"));
  EXPECT_FALSE(joinNetwork("nowhere", 1));
}

}  // namespace
}  // namespace forewalk::service
