// Applies gains: keeps the rigid map from physical to virtual space and changes it a little every
// frame.
//
// The world is turned about the user's head and pushed along the user's step, so that nothing ever
// jumps for the one who looks. Turning the world by phi turns what the user sees by phi at once; a
// walker who keeps to the virtual path then turns physically by -phi.
#pragma once

#include "rdw/gains.h"
#include "rdw/motion.h"
#include "rdw/pose.h"

namespace forewalk::rdw {

/// The rigid map from physical to virtual space at this moment: plan points turn by `yaw` about the
/// origin, then move by `offset`; heights move by `height` (the virtual height of the physical
/// floor).
struct Redirection {
  double yaw = 0.0;        ///< radians, left positive, in (-pi, pi]
  glm::dvec2 offset{0.0};  ///< metres, plan
  double height = 0.0;     ///< metres

  bool operator==(const Redirection&) const = default;

  /// Plan points and directions, there and back.
  glm::dvec2 toVirtual(glm::dvec2 physical) const;
  glm::dvec2 toPhysical(glm::dvec2 virtualPoint) const;
  glm::dvec2 directionToVirtual(glm::dvec2 physical) const { return rotated(physical, yaw); }
  glm::dvec2 directionToPhysical(glm::dvec2 virtualDirection) const {
    return rotated(virtualDirection, -yaw);
  }
  PlanarPose toVirtual(const PlanarPose& physical) const;
  PlanarPose toPhysical(const PlanarPose& virtualPose) const;

  /// A head in space. Under the identity the pose is returned to the bit.
  HeadPose toVirtual(const HeadPose& physical) const;
  HeadPose toPhysical(const HeadPose& virtualPose) const;
};

/// The map that takes `physical` to `virtualPose`; `height` is the virtual height of the physical
/// floor.
Redirection alignment(const PlanarPose& physical, const PlanarPose& virtualPose,
                      double height = 0.0);

/// What a frame's gains came to.
struct Applied {
  HeadPose virtualPose;
  double injectedYaw = 0.0;             ///< radians by which the world was turned, left positive
  glm::dvec2 injectedTranslation{0.0};  ///< metres by which the user was pushed, virtual plan
};

class Redirector {
 public:
  explicit Redirector(const Redirection& start = {}) : redirection_(start) {}

  const Redirection& redirection() const { return redirection_; }

  /// Replaces the map at once (start alignment, teleport). What the user sees jumps.
  void align(const Redirection& redirection) { redirection_ = redirection; }

  /// The virtual floor rises under the user (stairs): only heights change.
  void setHeight(double height) { redirection_.height = height; }

  /// Applies `gains` as given to one frame's motion that ended at `head` (physical):
  /// - translation: the user is pushed by (translation - 1) * step, along the virtual step;
  /// - rotation: the world turns by (rotation - 1) * turn, about the head;
  /// - curvature: the world turns by -curvature * distance;
  /// - bending: where the direction of travel turned physically by T, of which the curvature gain
  /// accounts
  ///   for curvature * distance, the rest R = T - curvature * distance is the walker following a
  ///   virtual curve. Physical turn = bending * virtual turn, so the world turns by (1 / bending -
  ///   1) * R.
  /// A neutral gain touches nothing: with all neutral the map keeps its bits. A motion that is not
  /// usable is not acted on. O(1), allocates nothing.
  Applied frame(const Motion& motion, const HeadPose& head, const Gains& gains);

  /// Turns the world about the head by `yaw` radians and pushes it by nothing: what a reset does.
  Applied turnWorld(const HeadPose& head, double yaw);

  /// The same, and the world moves along with the frame's step, so that the user stays where they
  /// were: what a frozen reset does.
  Applied freezeWorld(const HeadPose& head, double yaw, glm::dvec2 step);

 private:
  Applied inject(const HeadPose& head, double yaw, glm::dvec2 push);

  Redirection redirection_;
};

}  // namespace forewalk::rdw
