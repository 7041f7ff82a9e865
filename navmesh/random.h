// Random numbers that are the same everywhere.
//
// The engines of <random> are fixed by the standard, its distributions are not: these two stand in
// for them, so that a seed gives the same scene, start or walk on every platform.
#pragma once

#include <cassert>
#include <cstdint>
#include <random>

namespace forewalk::navmesh {

/// Uniform in [0, 1), from the upper 53 bits of one draw.
inline double uniform(std::mt19937_64& rng) { return static_cast<double>(rng() >> 11) * 0x1.0p-53; }

/// Uniform in [low, high), from one draw. Requires low <= high.
inline double uniform(std::mt19937_64& rng, double low, double high) {
  return low + (high - low) * uniform(rng);
}

/// Uniform in {0, ..., n - 1}, from one draw. Requires n >= 1.
inline int uniformInt(std::mt19937_64& rng, int n) {
  assert(n >= 1);
  // 31 bits of n keep the bias below 2^-22.
  return static_cast<int>(uniform(rng) * static_cast<double>(n));
}

}  // namespace forewalk::navmesh
