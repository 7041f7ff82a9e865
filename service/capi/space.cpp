#include <algorithm>
#include <memory>
#include <string>

#include "service/capi/axes.h"
#include "service/capi/space_handle.h"
#include "service/capi/status.h"

namespace forewalk::capi {

namespace {

constexpr float kDefaultSide = 4.0f;  // of the tracked space, metres

// More corners than TrackedSpace takes are counted, not read.
constexpr std::size_t kMostCorners = 4096;

// Right and forward are the plan's two axes in every convention; only the unit differs.
glm::dvec2 planFrom(forewalk_axes axes, forewalk_point2 theirs) {
  const double unit = unitsPerMetre(axes);
  return {static_cast<double>(theirs.right) / unit, static_cast<double>(theirs.forward) / unit};
}

forewalk_space_settings defaultSpaceSettings() {
  forewalk_space_settings settings{};
  settings.struct_size = sizeof settings;
  settings.axes = FOREWALK_AXES_OPENXR;
  settings.body_radius = static_cast<float>(rdw::OtherUser{}.radius);
  settings.user_limit = 16;
  return settings;
}

}  // namespace

forewalk_status checkForm(const SpaceForm& form, const char* type) {
  if (form.axes < FOREWALK_AXES_OPENXR || form.axes > FOREWALK_AXES_UNREAL) {
    return unknownConstant(type, "axes", form.axes, FOREWALK_AXES_UNREAL);
  }
  if ((form.border == nullptr && form.borderCount > 0) ||
      ((form.holePoints == nullptr || form.holeSizes == nullptr) && form.holeCount > 0)) {
    return fail(FOREWALK_ERROR_ARGUMENT,
                std::string(type) +
                    ": border, hole_points or hole_sizes is null while its count is not 0.");
  }
  std::size_t corners = form.borderCount;
  for (std::size_t i = 0; corners <= kMostCorners && i < form.holeCount; ++i) {
    // A hole of no points cannot be; counted as one, a wild hole_count ends here, too.
    corners += std::max<std::size_t>(1, std::min(form.holeSizes[i], kMostCorners + 1));
  }
  if (corners > kMostCorners) {
    return fail(FOREWALK_ERROR_TOO_LARGE, std::string(type) + ": the tracked space has more than " +
                                              std::to_string(kMostCorners) +
                                              " points. Simplify it.");
  }
  return FOREWALK_OK;
}

tl::expected<rdw::TrackedSpace, Error> makeSpace(const SpaceForm& form, const char* type) {
  if (form.borderCount == 0 && form.holeCount == 0) {
    const double unit = unitsPerMetre(form.axes);
    const auto side = [&](float theirs) {
      return theirs == 0.0f ? static_cast<double>(kDefaultSide)
                            : static_cast<double>(theirs) / unit;
    };
    return rdw::TrackedSpace::rectangle(side(form.width), side(form.depth));
  }
  if (form.borderCount == 0) {
    return tl::unexpected(
        Error{ErrorCode::kSettingOutOfRange,
              std::string(type) + ": holes without a border. Give the border's points."});
  }
  std::vector<glm::dvec2> border;
  border.reserve(form.borderCount);
  for (std::size_t i = 0; i < form.borderCount; ++i) {
    border.push_back(planFrom(form.axes, form.border[i]));
  }
  std::vector<std::vector<glm::dvec2>> holes(form.holeCount);
  const forewalk_point2* next = form.holePoints;
  for (std::size_t hole = 0; hole < holes.size(); ++hole) {
    for (std::size_t i = 0; i < form.holeSizes[hole]; ++i) {
      holes[hole].push_back(planFrom(form.axes, *next++));
    }
  }
  return rdw::TrackedSpace::polygon(border, holes);
}

}  // namespace forewalk::capi

using namespace forewalk;
using namespace forewalk::capi;

extern "C" {

void forewalk_space_settings_init(forewalk_space_settings* settings, uint32_t struct_size) {
  initKnown(defaultSpaceSettings(), settings, struct_size);
}

forewalk_status forewalk_space_create(const forewalk_space_settings* settings,
                                      forewalk_space** space) {
  if (space == nullptr) {
    return failLiteral(FOREWALK_ERROR_ARGUMENT, "forewalk_space_create: space is null.");
  }
  *space = nullptr;
  return guarded([&]() -> forewalk_status {
    constexpr const char* kType = "forewalk_space_settings";
    forewalk_space_settings known = defaultSpaceSettings();
    if (const auto status = readSettings(settings, kType, known)) return status;
    const SpaceForm form = spaceForm(known);
    if (const auto status = checkForm(form, kType)) return status;
    constexpr float kWidestBody = 5.0f;
    if (!(known.body_radius > 0.0f && known.body_radius <= kWidestBody)) {
      return fail(FOREWALK_ERROR_SETTING_OUT_OF_RANGE,
                  "forewalk_space_settings: a body_radius of " + std::to_string(known.body_radius) +
                      " m cannot work: give more than 0 and at most 5 m; 0.5 m is usual.");
    }
    if (known.user_limit < 1 || known.user_limit > SharedPlaces::kMost) {
      return fail(FOREWALK_ERROR_SETTING_OUT_OF_RANGE,
                  "forewalk_space_settings: a user_limit of " + std::to_string(known.user_limit) +
                      " cannot work: give 1 to " + std::to_string(SharedPlaces::kMost) + ".");
    }
    auto made = makeSpace(form, kType);
    if (!made) return fail(made.error());
    *space = new forewalk_space(std::move(*made), static_cast<double>(known.body_radius),
                                known.user_limit);
    return FOREWALK_OK;
  });
}

void forewalk_space_retain(forewalk_space* space) {
  if (space != nullptr) space->owners.fetch_add(1, std::memory_order_relaxed);
}

void forewalk_space_release(forewalk_space* space) {
  if (space == nullptr) return;
  if (space->owners.fetch_sub(1, std::memory_order_acq_rel) == 1) delete space;
}

}  // extern "C"
