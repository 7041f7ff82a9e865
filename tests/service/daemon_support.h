// What the daemon's tests share: a building, somebody who walks in it, sessions over the wire.
#pragma once

#include <gtest/gtest.h>
#include <spdlog/spdlog.h>

#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>

#include "navmesh/build/build.h"
#include "rdw/session.h"
#include "service/daemon/daemon.h"
#include "service/daemon/load.h"
#include "service/daemon/message.h"
#include "service/files.h"
#include "tests/support/web_client.h"

namespace forewalk::testing {

struct Building {
  std::string file;
  std::shared_ptr<const navmesh::World> world;
  daemon::NavMeshHash hash{};
};

inline Building buildingOf(const std::string& name) {
  Building building;
  building.file = FOREWALK_ASSETS "/scenes/" + name + ".obj";
  const auto navMesh = service::loadNavMesh(building.file).value();
  building.hash = daemon::hashOf(navMesh);
  building.world = service::makeWorld(navMesh).value();
  return building;
}

inline const Building& office() {
  static const Building building = buildingOf("office");
  return building;
}

inline constexpr const char* kKey = "0123456789abcdef0123456789abcdef";

/// On any free port, with a key that all share, and silent.
inline std::unique_ptr<daemon::Daemon> startDaemon(daemon::DaemonSettings settings = {}) {
  spdlog::set_level(spdlog::level::off);
  if (settings.stateKey.empty()) settings.stateKey = kKey;
  if (settings.threads == 0) settings.threads = 2;
  settings.scene = office().file;
  auto started = daemon::Daemon::start(office().world, office().hash, std::move(settings));
  EXPECT_TRUE(started) << (started ? "" : started.error().message);
  return std::move(*started);
}

/// Somebody who walks at 90 frames a second.
class Body : public daemon::MadeUpBody {
 public:
  using daemon::MadeUpBody::MadeUpBody;
  daemon::Frame next(bool turning) { return daemon::MadeUpBody::next(1.0 / 90.0, turning); }
};
inline const std::string kStart = R"("start":{"position":[7,0,12],"heading_deg":20})";

inline std::string sessionWith(const std::string& controller) {
  return "{\"controller\":\"" + controller + "\"," + kStart + "}";
}

/// A client with a session: hello said, welcome received.
class Walker {
 public:
  Walker(unsigned short port, const std::string& session, const std::string& from = {},
         const Headers& headers = {})
      : client(port, headers) {
    if (!client.open()) return;
    std::string hello = R"({"format":"forewalk.hello/1","session":)" + session;
    if (!from.empty()) hello += ",\"token\":\"" + from + "\"";
    client.send(hello + "}", true);
    welcome = nlohmann::json::parse(client.receive(30.0).value_or("{}"));
  }

  bool welcomed() const { return welcome.value("format", "") == "forewalk.welcome/1"; }
  std::string error() const { return welcome.value("code", ""); }

  /// A binary frame and its answer; the token is kept.
  std::optional<daemon::Answer> frame(const daemon::Frame& frame) {
    if (!client.send(daemon::frameBytes(frame), false)) return std::nullopt;
    last = client.receive().value_or("");
    const auto read = daemon::parseAnswerBytes(last);
    if (!read) return std::nullopt;
    token = daemon::toBase64Url(read->token);
    return read->answer;
  }

  WebClient client;
  nlohmann::json welcome;
  std::string token, last;
};

/// The code of an error message; "" for none.
inline std::string codeOf(const std::optional<std::string>& message) {
  if (!message) return "";
  const auto json = nlohmann::json::parse(*message, nullptr, false);
  return json.is_object() ? json.value("code", "") : "";
}

/// A session of our own, as the daemon makes it of these settings.
inline rdw::Session ourSession(const std::string& settings) {
  return rdw::Session::make(office().world, daemon::parseSettings(settings).value()).value();
}

}  // namespace forewalk::testing
