// What a body can do: motion clips, each with a linear and an angular velocity, and how to blend
// them for whatever lies between.
//
// A clip is a point (linear, angular); their Delaunay triangulation says which three clips make up
// a motion inside it, and the barycentric coordinates say how much of each. A motion outside cannot
// be played. Clips on one line (walks straight ahead only) make a chain: two clips a motion.
//
// The triangulation itself needs more than this room's libraries and is in clip_triangulation.h;
// the built-in database comes triangulated.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <tl/expected.hpp>
#include <utility>
#include <vector>

#include "navmesh/error.h"

namespace forewalk::agents {

/// A motion held for a while: walks at `linear` m/s and turns at `angular` rad/s, left positive.
struct Command {
  float linear = 0.0f;
  float angular = 0.0f;
  bool operator==(const Command&) const = default;
};

struct MotionClip {
  std::string name;  ///< the engine's, for its own use
  Command motion;    ///< played as it was made
};

/// Which clips to play together. Weights are in [0, 1] and add up to 1; a clip that is not needed
/// has weight 0 and repeats the first.
struct ClipBlend {
  std::array<std::uint32_t, 3> clip{};
  std::array<float, 3> weight{1.0f, 0.0f, 0.0f};
};

using ClipTriangle = std::array<std::uint32_t, 3>;

/// How far a motion may lie outside of what the clips span and still count as inside; and clips
/// that lie no further than this from one line make a chain. m/s and rad/s.
inline constexpr float kClipTolerance = 1e-3f;

/// Clips and their triangles; never changes. Linear speeds are 0 or more.
class LocomotionDatabase {
 public:
  /// `triangles` cover the convex hull of the clips, no corner twice, either way round; none where
  /// the clips lie on one line. Fails (kSettingOutOfRange, naming the clip) when there is no clip,
  /// a number is not finite, a linear speed is negative, a triangle names a clip that is not there,
  /// or there are no triangles but the clips are not on one line.
  [[nodiscard]] static tl::expected<LocomotionDatabase, Error> make(
      std::vector<MotionClip> clips, std::vector<ClipTriangle> triangles);

  std::span<const MotionClip> clips() const { return clips_; }
  std::span<const ClipTriangle> triangles() const { return triangles_; }

  /// The clips in order along their line, where they lie on one; else empty. Clips with equal
  /// motions are named once.
  std::span<const std::uint32_t> chain() const { return chain_; }

  /// The smallest and the largest velocities of all clips.
  Command lowest() const { return lowest_; }
  Command highest() const { return highest_; }

  /// The clip that is nearest to standing still.
  std::uint32_t neutral() const { return neutral_; }

  /// The angular velocities that can be had at a linear one, from low to high; low > high where
  /// there is none. O(edges of the hull).
  std::pair<float, float> angularAt(float linear) const;

  /// A motion on the chain, `share` of its length from its beginning, in [0, 1]. There must be one.
  Command alongChain(float share) const;

  /// The blend for a motion, or nothing where it lies outside. O(triangles).
  std::optional<ClipBlend> blend(Command motion) const;

  /// The motion of a blend.
  Command motionOf(const ClipBlend& blend) const;

 private:
  LocomotionDatabase() = default;

  std::vector<MotionClip> clips_;
  std::vector<ClipTriangle> triangles_;
  std::vector<std::uint32_t> chain_;
  struct Edge {
    Command low, high;  // low.linear <= high.linear
  };
  std::vector<Edge> hull_;
  Command lowest_, highest_;
  std::uint32_t neutral_ = 0;
};

/// The order, from slow to fast, of clips that lie on one line within kClipTolerance, or nothing where they do not.
/// Clips closer than the tolerance to an earlier one are left out. O(n log n).
std::optional<std::vector<std::uint32_t>> chainOf(std::span<const MotionClip> clips);

/// A person's clips: standing, turning on the spot, walking slowly, walking, walking fast and
/// jogging, each straight and to both sides.
std::shared_ptr<const LocomotionDatabase> builtInClips();

/// How fast to play a blend so that the feet keep up with a body that moves at `speed` m/s: the
/// ratio of the speeds within what looks natural, 0.3 to 1.2; 1 for a blend that stands.
float replayRatio(float speed, float blendSpeed);

}  // namespace forewalk::agents
