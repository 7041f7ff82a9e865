// In which order the roots of a front lie along it, piece by piece: so that it is known which piece
// passes at a place that a root sees, without following any.
//
// Where one root is nearest, the front is a circle about it. So a piece of the front is a row of
// sectors, each that of one root between two directions. A new root is always a corner of the wall
// that a piece ends on, and comes to lie at that end of the row; where the front splits the sector
// of the root that sees the place is cut there, and where pieces meet their rows are joined. Roots
// that nothing is left of stay in their rows and do no harm (wavefronts as lists of bunches:
// Hershberger and Suri, "An optimal algorithm for Euclidean shortest paths in the plane", SIAM J.
// Comput. 28, 1999; here the events are known beforehand).
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "prediction/funnel_tree.h"

namespace forewalk::prediction {

class FrontOrder {
 public:
  /// Room for so many roots and stretches of wall; where more are seen, buffers grow.
  void reserve(std::size_t roots, std::size_t stretches);

  /// One closed piece about root 0. Roots are below `roots`, stretches of wall (wall_profile.h)
  /// below `stretches`.
  void start(std::size_t roots, std::size_t stretches);

  /// Root `root` comes to lie at the end of a piece, on a stretch: one that runs against the
  /// border's direction holds left ends, one that runs in it right ends. `arrival`: the way that it
  /// is reached by, of any length but zero. False where no piece ends there.
  bool add(std::uint32_t root, glm::dvec2 arrival, std::uint32_t stretch);
  /// The same where the front split at the root itself, which lies at an end of both pieces.
  bool addBetween(std::uint32_t root, glm::dvec2 arrival, std::uint32_t leftEnd,
                  std::uint32_t rightEnd);

  /// The sector of `root` that a direction lies in; kNone where the root is not known. O(sectors of
  /// the root).
  std::uint32_t sectorOf(std::uint32_t root, glm::dvec2 direction) const;

  /// The stretch that the left end of the piece with that sector lies on; kNone: it is closed.
  /// O(sectors of the piece).
  std::uint32_t leftEndOf(std::uint32_t sector) const;

  /// The piece ends in that direction on two stretches from now on: what lies to the left of it on
  /// `rightEnd`, what lies to the right on `leftEnd`. A closed one is one piece still.
  void split(std::uint32_t sector, glm::dvec2 direction, std::uint32_t leftEnd,
             std::uint32_t rightEnd);

  /// A right end and a left end run into each other: the two pieces go on as one, or one goes on
  /// closed. False where nothing ends there.
  bool join(std::uint32_t rightEnd, std::uint32_t leftEnd);

  /// Two places of fronts meet, neither at an end: what is left of the one goes on with what is
  /// right of the other.
  void meet(std::uint32_t sectorA, glm::dvec2 directionA, std::uint32_t sectorB,
            glm::dvec2 directionB);

 private:
  struct Sector {
    std::uint32_t left, right;  // neighbours, as one looks outward; kNone at the ends of a piece
    std::uint32_t leftEnd;      // the stretch that it ends on there, if it does
    std::uint32_t next;         // another of the same root, or kNone
    glm::dvec2 from;            // where it begins, counter-clockwise
  };
  struct Cut {
    std::uint32_t left, right;  // sectors
  };
  std::uint32_t addSector(std::uint32_t root, glm::dvec2 from);
  void putAtEnd(std::uint32_t sector, std::uint32_t stretch);
  Cut cut(std::uint32_t sector, glm::dvec2 direction);

  std::vector<Sector> sectors_;
  std::vector<std::uint32_t> firstOf_;  // per root: a sector, or kNone
  std::vector<glm::dvec2> base_;        // per root: where the first of its sectors begins
  std::vector<std::uint32_t> endAt_;    // per stretch: the sector that ends there, or kNone
  std::vector<std::uint32_t> rootOf_;   // per sector
  bool uncut_ = true;                   // the first one is a full turn still, without beginning
};

}  // namespace forewalk::prediction
