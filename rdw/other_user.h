// The others in a room that several people share, each in a virtual world of their own or in one.
#pragma once

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <glm/glm.hpp>
#include <optional>
#include <span>
#include <vector>

namespace forewalk::rdw {

/// Somebody else in the tracked space: a moving circle. Physical plan, metres.
struct OtherUser {
  glm::dvec2 position{0.0};
  glm::dvec2 velocity{0.0};  ///< m/s
  glm::dvec2 facing{0.0};    ///< unit vector; zero where it is not known
  double radius = 0.5;       ///< how near the middles of two bodies may come, metres, > 0
};

/// Others that a session looks at in a frame; of more the nearest are kept.
inline constexpr std::size_t kMostOthers = 15;

/// Who is where in one room, for callers that run all its sessions in one loop: each frame place()
/// everybody, then hand othersOf(user) to their session (Session::setOthers).
class SharedSpace {
 public:
  explicit SharedSpace(std::size_t users) : users_(users) { others_.reserve(users); }

  std::size_t size() const { return users_.size(); }

  void place(std::size_t user, const OtherUser& where) { users_[user] = where; }
  void leave(std::size_t user) { users_[user].reset(); }

  /// All who are in the room but `user`. Valid until the next call. O(users), allocates nothing.
  std::span<const OtherUser> othersOf(std::size_t user) {
    assert(user < users_.size());
    others_.clear();
    for (std::size_t i = 0; i < users_.size(); ++i) {
      if (i != user && users_[i]) others_.push_back(*users_[i]);
    }
    return others_;
  }

 private:
  std::vector<std::optional<OtherUser>> users_;
  std::vector<OtherUser> others_;
};

}  // namespace forewalk::rdw
