#include "rdw/openrdw_text.h"

#include <cmath>
#include <locale>
#include <sstream>
#include <string>

namespace forewalk::rdw {

bool isBlank(std::string_view line) {
  return line.find_first_not_of(" \t\r\v\f") == std::string_view::npos;
}

std::optional<double> readNumber(std::string_view line) {
  std::istringstream words{std::string(line)};
  words.imbue(std::locale::classic());
  double number = 0.0;
  char rest = 0;
  if (!(words >> number) || words >> rest || !std::isfinite(number)) return std::nullopt;
  return number;
}

std::optional<glm::dvec2> readPoint(std::string_view line) {
  const std::size_t comma = line.find(',');
  if (comma == std::string_view::npos) return std::nullopt;
  const auto x = readNumber(line.substr(0, comma));
  const auto y = readNumber(line.substr(comma + 1));
  if (!x || !y) return std::nullopt;
  return glm::dvec2(*x, *y);
}

}  // namespace forewalk::rdw
