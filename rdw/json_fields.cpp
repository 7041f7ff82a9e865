#include "rdw/json_fields.h"

#include <algorithm>

namespace forewalk::rdw {
namespace {

/// Letters to change, add or drop to get from one word to the other (Levenshtein 1966).
std::size_t lettersApart(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  for (std::size_t j = 0; j < row.size(); ++j) row[j] = j;
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = row[0]++;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t changed = diagonal + (a[i] == b[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({changed, row[j] + 1, diagonal + 1});
    }
  }
  return row.back();
}

}  // namespace

std::string suggestion(std::string_view wrong, std::span<const std::string_view> known) {
  const auto nearest = std::min_element(known.begin(), known.end(), [&](auto a, auto b) {
    return lettersApart(wrong, a) < lettersApart(wrong, b);
  });
  if (nearest != known.end() &&
      lettersApart(wrong, *nearest) <= std::max<std::size_t>(2, nearest->size() / 2)) {
    return fmt::format("did you mean \"{}\"?", *nearest);
  }
  return fmt::format("known are: {}.", fmt::join(known, ", "));
}

void requireFormat(Fields& file, std::string_view format) {
  const Json* field = file.find("format");
  if (field == nullptr || !field->is_string()) {
    file.problem().say(ErrorCode::kFormatUnknown,
                       fmt::format("\"format\" is missing; this reads \"{}\".", format));
  } else if (field->get_ref<const std::string&>() != format) {
    file.problem().say(ErrorCode::kFormatUnsupported,
                       fmt::format("\"format\" is {}; this reads \"{}\".",
                                   inQuotes(field->get_ref<const std::string&>()), format));
  }
}

void readImport(Fields& file, navmesh::ImportSettings& import) {
  const Json* object = file.find("import");
  if (object == nullptr) return;
  Fields fields(*object, "import.", file.problem());
  fields.number("metres_per_unit", 1e-6, 1e6, import.metresPerUnit);
  static constexpr std::string_view kAxes[] = {"y", "z"};
  std::size_t up = import.up == navmesh::UpAxis::kY ? 0 : 1;
  fields.word("up", kAxes, up);
  import.up = up == 0 ? navmesh::UpAxis::kY : navmesh::UpAxis::kZ;
  fields.finish();
}

// Ranges that the settings share are left to the builder, which knows what follows from which.
void readBuild(Fields& file, navmesh::BuildSettings& build) {
  const Json* object = file.find("build");
  if (object == nullptr) return;
  Fields fields(*object, "build.", file.problem());
  fields.number("radius_m", 0.0, 10.0, build.radius);
  fields.number("height_m", 0.01, 100.0, build.height);
  fields.number("climb_m", 0.0, 10.0, build.climb);
  fields.number("slope_deg", 0.0, 89.9, build.slope, kDegree);
  fields.number("cell_m", 0.001, 10.0, build.cell);
  fields.number("cell_height_m", 0.001, 10.0, build.cellHeight);
  fields.number("region_min_m2", 0.0, 1e6, build.regionMin);
  fields.number("region_merge_m2", 0.0, 1e6, build.regionMerge);
  fields.number("edge_max_m", 0.0, 1e5, build.edgeMax);
  fields.number("edge_error_m", 0.0, 100.0, build.edgeError);
  fields.number("detail_sample_m", 0.0, 100.0, build.detailSample);
  fields.number("detail_error_m", 0.0, 100.0, build.detailError);
  fields.integer("corners_max", 3, 6, build.cornersMax);
  static constexpr std::string_view kPartitions[] = {"watershed", "monotone", "layers"};
  std::size_t partition = static_cast<std::size_t>(build.partition);
  fields.word("partition", kPartitions, partition);
  build.partition = static_cast<navmesh::Partition>(partition);
  fields.number("tile_m", 0.0, 1e5, build.tile);
  fields.finish();
}

}  // namespace forewalk::rdw
