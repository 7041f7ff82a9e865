// How far apart two paths are: dynamic time warping.
//
// Sakoe and Chiba (IEEE Trans. ASSP 26, 1978), in the form of Ono's thesis (UCL 2011):
//
//   g(i, j) = |a_i - b_j| + min(g(i-1, j), g(i-1, j-1), g(i, j-1))
//
// without weights and without a window; outside the table g is infinite (the thesis has NaN there
// and relies on a minimum that skips it), and before its first cell it is 0. The result is the last
// cell.
//
// The raw sum grows with the number of samples, so a slow walker or a faster tracker makes paths
// more different than they are. The normalised form is free of that: both paths are first resampled
// at one spacing along their length, and the sum is divided by how many samples that makes a path.
#pragma once

#include <glm/glm.hpp>
#include <span>
#include <vector>

namespace forewalk::agents {

/// The raw sum, metres times samples. Symmetric to the last bit, and 0 for equal paths; not a
/// metric: the triangle inequality does not hold, and paths that differ only in how often a place
/// is sampled are 0 apart.
///
/// REQUIRES: both paths have a sample, all finite. Costs O(a * b) time and O(a + b) memory.
double dtw(std::span<const glm::dvec2> a, std::span<const glm::dvec2> b);

/// The sum of the distances between neighbours, metres.
double pathLength(std::span<const glm::dvec2> path);

/// Points along the polyline at equal steps of its length: as many whole steps as come nearest to
/// `spacing` metres, at least one, both ends included. One point where the path has no length.
///
/// REQUIRES: a sample or more, all finite; spacing > 0; length / spacing below 2^31. O(samples +
/// result).
std::vector<glm::dvec2> resampleByLength(std::span<const glm::dvec2> path, double spacing);

/// Metres: the raw sum of both paths resampled at `spacing`, over the mean of their sample counts.
/// Two equal paths side by side at a distance D have D. Does not depend on how the paths were
/// sampled in time, and on `spacing` only as far as that cuts corners.
///
/// REQUIRES as above. Costs as dtw of the resampled paths.
double normalisedDtw(std::span<const glm::dvec2> a, std::span<const glm::dvec2> b, double spacing);

}  // namespace forewalk::agents
