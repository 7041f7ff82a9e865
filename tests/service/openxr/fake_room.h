// The fake runtime's room: the recorded walk, and where everything is in it, frame by frame.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "service/openxr/api.h"
#include "service/openxr/rigid.h"

namespace forewalk::testing {

using openxr::inverse;
using openxr::levelRigid;
using openxr::poseOf;
using openxr::Rigid;
using openxr::rigidOf;

inline constexpr XrTime kStart = 1'000'000'000'000;  // of the first frame
inline constexpr XrDuration kPeriod = 11'111'111;    // nanoseconds a frame

/// What spaces are made from.
enum class Anchor { kView, kLocal, kStage, kHand };

inline bool isBody(Anchor anchor) { return anchor == Anchor::kView || anchor == Anchor::kHand; }

/// As the environment orders it (fake_runtime.cpp).
struct FakeRoom {
  std::vector<XrPosef> walk;  ///< the head in STAGE, a pose a frame
  bool hasStage = true, hasTint = true, hasBounds = false;
  XrExtent2Df bounds{};
  Anchor moving = Anchor::kLocal;  ///< its origin comes to the head in changeFrame
  int changeFrame = -1, lostFirst = -1, lostLast = -2;

  static FakeRoom fromEnvironment() {
    FakeRoom room;
    const auto order = [](const char* name) {
      const char* text = std::getenv(name);
      return std::istringstream(text == nullptr ? "" : text);
    };
    std::ifstream file(order("FAKE_OPENXR_WALK").str());
    for (std::string line; std::getline(file, line);) {
      XrPosef pose;
      XrVector3f& p = pose.position;
      XrQuaternionf& q = pose.orientation;
      if (std::sscanf(line.c_str(), "%f %f %f %f %f %f %f", &p.x, &p.y, &p.z, &q.x, &q.y, &q.z,
                      &q.w) == 7) {
        room.walk.push_back(pose);
      }
    }
    room.hasStage = std::getenv("FAKE_OPENXR_NO_STAGE") == nullptr;
    room.hasTint = std::getenv("FAKE_OPENXR_NO_TINT") == nullptr;
    auto size = order("FAKE_OPENXR_BOUNDS");
    room.hasBounds = static_cast<bool>(size >> room.bounds.width >> room.bounds.height);
    auto recentre = order("FAKE_OPENXR_RECENTRE");
    std::string which;
    if (recentre >> which >> room.changeFrame) {
      room.moving = which == "stage" ? Anchor::kStage : Anchor::kLocal;
    }
    auto lost = order("FAKE_OPENXR_LOST");
    if (lost >> which) {
      room.lostFirst = std::atoi(which.c_str());
      lost >> room.lostLast;
    }
    return room;
  }

  int frameAt(XrTime time) const {
    const XrTime last = static_cast<XrTime>(walk.size()) - 1;
    return static_cast<int>(std::clamp<XrTime>((time - kStart) / kPeriod, 0, last));
  }

  bool isLost(int frame) const { return frame >= lostFirst && frame <= lostLast; }

  Rigid head(int frame) const { return rigidOf(walk[static_cast<std::size_t>(frame)]); }

  Rigid anchor(Anchor anchor, int frame) const {
    const bool moved = changeFrame >= 0 && anchor == moving && frame >= changeFrame;
    switch (anchor) {
      case Anchor::kView:
        return head(frame);
      case Anchor::kHand:
        return head(frame) * levelRigid(0.4, {0.25, -0.35, -0.3});
      case Anchor::kLocal:
        return moved ? level(head(changeFrame), head(changeFrame).move.y)
                     : levelRigid(0.3, {0.4, 1.5, -0.2});
      case Anchor::kStage:
        return moved ? level(head(changeFrame), 0.0) : Rigid{};
    }
    return {};
  }

 private:
  static Rigid level(const Rigid& pose, double height) {
    const glm::dvec3 ahead = pose.turn * glm::dvec3(0.0, 0.0, -1.0);
    return levelRigid(std::atan2(-ahead.x, -ahead.z), {pose.move.x, height, pose.move.z});
  }
};

}  // namespace forewalk::testing
