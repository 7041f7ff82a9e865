// The results of an experiment as one self-contained page, for people and papers.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <tl/expected.hpp>
#include <vector>

#include "navmesh/error.h"
#include "service/experiment/results.h"
#include "service/experiment/statistics.h"

namespace forewalk::service {

/// A picture and the numbers in it.
struct Figure {
  std::string file;     ///< without its ending: "resets_museum"
  std::string caption;  ///< a sentence or two, plain text
  std::string svg;
  std::string csv;
};

/// Box plots and lines of resets for a block. O(rows).
std::vector<Figure> resetFigures(const Results& results, const Block& block, std::size_t number);

/// Where the body was in each room under each controller, of a block.
Figure heatFigure(const Results& results, const Block& block, std::size_t number);

/// First walks as they went in the room and in the virtual world, for runs whose traces lie in
/// `folder`/traces; those without are left out.
std::vector<Figure> walkFigures(const Results& results, const std::filesystem::path& folder,
                                const Block& block, std::size_t number);

/// Writes index.html, which needs no other file, and figures/ with every figure as SVG and CSV.
/// `folder` is where the results lie, `baseline` a controller of the plan, or empty for its first.
/// How many figures there are.
///
/// Fails when the plan has no such controller (kSettingOutOfRange, with those it has), no run
/// succeeded (kDataDamaged), or as writeFile.
[[nodiscard]] tl::expected<std::size_t, Error> writeReport(const Results& results,
                                                           const std::filesystem::path& folder,
                                                           const std::string& baseline,
                                                           const std::filesystem::path& out);

}  // namespace forewalk::service
