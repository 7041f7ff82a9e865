// The messages of a networked crowd from any bytes; what is accepted is written back as it came,
// and neither a client nor a server is harmed by it.
#include <cmath>
#include <cstring>

#include "agents/published_scenes.h"
#include "service/crowd_wire.h"
#include "tests/fuzz/fuzz.h"

namespace {

using namespace forewalk;

using forewalk::testing::require;

void requireFinite(const agents::Crowd& crowd) {
  for (const glm::vec2 at : crowd.view().position) {
    require(std::isfinite(at.x) && std::isfinite(at.y), "positions are finite");
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto* bytes = reinterpret_cast<const std::byte*>(data);
  const auto message = service::decode({bytes, size});
  if (!message) {
    const std::string& sentence = message.error().message;
    require(sentence.starts_with("crowd message: ") && sentence.size() < 200,
            "a refusal says where, and is short");
    return 0;
  }
  std::vector<std::byte> again;
  service::encode(*message, again);
  require(again.size() == size + 4 && std::memcmp(again.data() + 4, bytes, size) == 0,
          "what was accepted is written back as it came");
  static const agents::CrowdScene scene = agents::circleScene(4);
  auto server = agents::NetworkServer::make(scene, {});
  require(server.has_value(), "the scene is sound");
  if (const auto* command = std::get_if<agents::NetworkCommand>(&*message)) {
    server->receive(0, *command);
    server->step();
    requireFinite(server->crowd());
  } else if (const auto* snapshot = std::get_if<agents::NetworkSnapshot>(&*message)) {
    agents::NetworkClient client(server->welcome(0));
    client.receive(*snapshot);
    (void)client.step();
  } else if (const auto* welcome = std::get_if<agents::NetworkWelcome>(&*message)) {
    if (welcome->members.size() + welcome->walls.size() > 200) return 0;
    agents::NetworkClient client(*welcome);
    (void)client.step();
  }
  return 0;
}

std::vector<std::vector<std::uint8_t>> seedCorpus() {
  auto server = agents::NetworkServer::make(agents::circleScene(4), {});
  agents::NetworkClient client(server->welcome(0));
  server->step();
  std::vector<std::vector<std::uint8_t>> seeds;
  for (const service::NetworkMessage& message :
       {service::NetworkMessage(server->welcome(0)), service::NetworkMessage(server->snapshot(0)),
        service::NetworkMessage(client.step()), service::NetworkMessage(service::NetworkTick{}),
        service::NetworkMessage(service::NetworkBye{})}) {
    std::vector<std::byte> bytes;
    service::encode(message, bytes);
    const auto* first = reinterpret_cast<const std::uint8_t*>(bytes.data());
    seeds.emplace_back(first + 4, first + bytes.size());
  }
  return seeds;
}
