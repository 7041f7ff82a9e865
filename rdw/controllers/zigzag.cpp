// Zigzag. Razzaque, Kohn and Whitton, "Redirected Walking", Eurographics 2001.
//
// Somebody whose virtual way is a zigzag walks to and fro between two physical targets: at each
// virtual corner they turn toward the other one. The targets are the ends of the longest of 36
// chords through the centre, a metre from the border. Theirs are set by the virtual corners, which
// are known in advance; ours change when the user, nearer to the present one, turns on the spot, or
// comes within a metre of it.
#include <algorithm>
#include <array>
#include <cmath>

#include "rdw/controllers/controllers.h"
#include "rdw/steer_to.h"

namespace forewalk::rdw {
namespace {

constexpr int kChords = 36;
constexpr double kFromBorder = 1.0;              // metres
constexpr double kReached = 1.0;                 // metres
constexpr double kTurning = 20.0 * kPi / 180.0;  // rad/s

class Zigzag final : public Controller {
 public:
  void prepare(const TrackedSpace& space, const GainLimits&) override {
    const glm::dvec2 centre = space.centre();
    // Ordered from the longest edge, so that the room may be turned.
    glm::dvec2 first(1.0, 0.0);
    double longestEdge = 0.0;
    const auto ring = space.ring(0);
    for (std::size_t i = 0, j = ring.size() - 1; i < ring.size(); j = i++) {
      const double length = glm::distance(ring[i], ring[j]);
      if (length <= longestEdge + 1e-6) continue;
      longestEdge = length;
      first = (ring[i] - ring[j]) / length;
    }
    double longest = -1.0;
    for (int i = 0; i < kChords; ++i) {
      const glm::dvec2 way = rotated(first, kPi * i / kChords);
      const double there = space.distanceAlong(centre, way);
      const double back = space.distanceAlong(centre, -way);
      if (there + back <= longest + 1e-6) continue;
      longest = there + back;
      targets_ = {centre + std::max(0.5 * there, there - kFromBorder) * way,
                  centre - std::max(0.5 * back, back - kFromBorder) * way};
    }
    restart();
  }

  Gains steer(const SteerInput& input) override {
    const glm::dvec2 position = input.physical.position;
    const glm::dvec2 heading = directionOf(input.physical.heading);
    if (!chosen_) {
      chosen_ = true;
      at_ = std::abs(angleBetween(heading, targets_[0] - position)) <=
                    std::abs(angleBetween(heading, targets_[1] - position))
                ? 0
                : 1;
    }
    const Motion& motion = input.motion;
    const double here = glm::distance(position, targets_[at_]);
    const bool corner = !motion.walking && std::abs(motion.turnRate) > kTurning;
    const bool nearer = here < glm::distance(position, targets_[1 - at_]);
    // A corner counts once.
    if (here < kReached || (corner && !turning_ && nearer)) at_ = 1 - at_;
    turning_ = corner;
    return asGains(core_.steer(motion, position, heading, targets_[at_], input.limits), motion,
                   input.limits);
  }

  void restart() override {
    core_.restart();
    chosen_ = false;
    turning_ = false;
    at_ = 0;
  }
  std::string_view name() const override { return "zigzag"; }
  bool wantsPrediction() const override { return false; }

 private:
  std::array<glm::dvec2, 2> targets_{};
  std::size_t at_ = 0;
  bool chosen_ = false;
  bool turning_ = false;
  SteerToCore core_;
};

}  // namespace

std::unique_ptr<Controller> makeZigzag() { return std::make_unique<Zigzag>(); }

}  // namespace forewalk::rdw
