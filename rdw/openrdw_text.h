// What OpenRDW's text files are made of: a line `x,y` a point. For rdw alone: not installed.
//
// Its y points away from somebody who looks along Unity's +z, in a space seen from above, so that
// the pairs are plan coordinates (navmesh/plan.h) as they stand: world z = -y.
#pragma once

#include <glm/glm.hpp>
#include <optional>
#include <string_view>

namespace forewalk::rdw {

/// Nothing but white space.
bool isBlank(std::string_view line);

/// A finite number alone on a line, whatever the program's locale is; nothing where there is none.
std::optional<double> readNumber(std::string_view line);

/// `x,y`, with or without spaces; both finite.
std::optional<glm::dvec2> readPoint(std::string_view line);

}  // namespace forewalk::rdw
