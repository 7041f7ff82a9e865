// What a forewalk_space is: the room, and where everybody in it is.
#pragma once

#include <glm/glm.hpp>

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <optional>
#include <tl/expected.hpp>
#include <utility>
#include <vector>

#include "navmesh/error.h"
#include "rdw/other_user.h"
#include "rdw/tracked_space.h"
#include "service/capi/forewalk.h"

namespace forewalk::capi {

/// A tracked space in a C caller's numbers, of whichever struct.
struct SpaceForm {
  forewalk_axes axes;
  const forewalk_point2* border;
  std::size_t borderCount;
  float width, depth;
  const forewalk_point2* holePoints;
  const std::size_t* holeSizes;
  std::size_t holeCount;
};

template <typename Settings>
SpaceForm spaceForm(const Settings& settings) {
  return {settings.axes,  settings.border,      settings.border_count, settings.width,
          settings.depth, settings.hole_points, settings.hole_sizes,   settings.hole_count};
}

/// FOREWALK_OK, or the refusal of what cannot even be read; `type` names the struct in it.
forewalk_status checkForm(const SpaceForm& form, const char* type);

/// Of a form that was checked. Fails as TrackedSpace does.
tl::expected<rdw::TrackedSpace, Error> makeSpace(const SpaceForm& form, const char* type);

/// Who is where, exchanged between frames on any threads: each user writes a place of their own,
/// all read all. Neither locks nor allocates. A vector is one word, so that nobody reads half of
/// one; that a position may be a frame newer than its velocity does no harm.
class SharedPlaces {
 public:
  static constexpr std::size_t kMost = 64;
  using Index = std::size_t;

  explicit SharedPlaces(std::size_t users) : places_(users) {}

  /// A place for somebody, who is nowhere at first. None where all are taken.
  std::optional<Index> take() {
    for (Index i = 0; i < places_.size(); ++i) {
      bool taken = false;
      if (places_[i].taken.compare_exchange_strong(taken, true)) return i;
    }
    return std::nullopt;
  }
  void giveBack(Index user) {
    places_[user].present.store(false);
    places_[user].taken.store(false);
  }

  void put(Index user, glm::vec2 position, glm::vec2 velocity, glm::vec2 facing) {
    Place& place = places_[user];
    place.velocity.store(wordOf(velocity), std::memory_order_relaxed);
    place.facing.store(wordOf(facing), std::memory_order_relaxed);
    place.position.store(wordOf(position), std::memory_order_relaxed);
    place.present.store(true, std::memory_order_release);
  }

  /// All but `user`, in the order of their places. Returns how many.
  std::size_t othersOf(Index user, double radius, std::array<rdw::OtherUser, kMost>& others) const {
    std::size_t count = 0;
    for (Index i = 0; i < places_.size(); ++i) {
      const Place& place = places_[i];
      if (i == user || !place.present.load(std::memory_order_acquire)) continue;
      others[count++] = {glm::dvec2(vectorOf(place.position.load(std::memory_order_relaxed))),
                         glm::dvec2(vectorOf(place.velocity.load(std::memory_order_relaxed))),
                         glm::dvec2(vectorOf(place.facing.load(std::memory_order_relaxed))),
                         radius};
    }
    return count;
  }

 private:
  struct Place {
    std::atomic<bool> taken{false}, present{false};
    std::atomic<std::uint64_t> position{0}, velocity{0}, facing{0};
  };
  static_assert(std::atomic<std::uint64_t>::is_always_lock_free);

  static std::uint64_t wordOf(glm::vec2 vector) {
    std::uint64_t word;
    static_assert(sizeof word == sizeof vector);
    std::memcpy(&word, &vector, sizeof word);
    return word;
  }
  static glm::vec2 vectorOf(std::uint64_t word) {
    glm::vec2 vector;
    std::memcpy(&vector, &word, sizeof word);
    return vector;
  }

  std::vector<Place> places_;
};

}  // namespace forewalk::capi

struct forewalk_space {
  forewalk_space(forewalk::rdw::TrackedSpace made, double bodyRadius, std::size_t users)
      : space(std::move(made)), radius(bodyRadius), places(users) {}

  const forewalk::rdw::TrackedSpace space;
  const double radius;
  forewalk::capi::SharedPlaces places;
  std::atomic<std::uint32_t> owners{1};
};

namespace forewalk::capi {

/// A session's share in a space: its place there, and its ownership.
class SpaceMember {
 public:
  SpaceMember() = default;
  SpaceMember(forewalk_space& space, SharedPlaces::Index place) : space_(&space), place_(place) {
    forewalk_space_retain(&space);
  }
  SpaceMember(SpaceMember&& other) noexcept
      : space_(std::exchange(other.space_, nullptr)), place_(other.place_) {}
  SpaceMember& operator=(SpaceMember&& other) noexcept {
    std::swap(space_, other.space_);
    std::swap(place_, other.place_);
    return *this;
  }
  ~SpaceMember() {
    if (space_ == nullptr) return;
    space_->places.giveBack(place_);
    forewalk_space_release(space_);
  }

  explicit operator bool() const { return space_ != nullptr; }
  void put(glm::dvec2 position, glm::dvec2 velocity, glm::dvec2 facing) {
    space_->places.put(place_, glm::vec2(position), glm::vec2(velocity), glm::vec2(facing));
  }
  std::size_t others(std::array<rdw::OtherUser, SharedPlaces::kMost>& into) const {
    return space_->places.othersOf(place_, space_->radius, into);
  }

 private:
  forewalk_space* space_ = nullptr;
  SharedPlaces::Index place_ = 0;
};

}  // namespace forewalk::capi
