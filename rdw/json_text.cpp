#include "rdw/json_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <string>

namespace forewalk::rdw {
namespace {

using Json = nlohmann::json;

constexpr int kDeepest = 32;

/// Looks for the first fault only: nlohmann names its place by exception otherwise.
struct FirstFault {
  std::size_t position = 0;  // byte, from 1; 0: nothing malformed
  int depth = 0;

  bool null() { return true; }
  bool boolean(bool) { return true; }
  bool number_integer(Json::number_integer_t) { return true; }
  bool number_unsigned(Json::number_unsigned_t) { return true; }
  bool number_float(Json::number_float_t, const Json::string_t&) { return true; }
  bool string(Json::string_t&) { return true; }
  bool binary(Json::binary_t&) { return true; }
  bool key(Json::string_t&) { return true; }
  bool start_object(std::size_t) { return ++depth <= kDeepest; }
  bool start_array(std::size_t) { return ++depth <= kDeepest; }
  bool end_object() { return --depth >= 0; }
  bool end_array() { return --depth >= 0; }
  bool parse_error(std::size_t at, const std::string&, const Json::exception&) {
    position = at;
    return false;
  }
};

}  // namespace

tl::expected<Json, Error> parseJson(std::string_view text, std::string_view name) {
  FirstFault fault;
  if (!Json::sax_parse(text.begin(), text.end(), &fault)) {
    if (fault.depth > kDeepest) {
      return tl::unexpected(Error{ErrorCode::kDataDamaged,
                                  fmt::format("{}: nested more than {} deep.", name, kDeepest)});
    }
    const auto end = text.begin() + static_cast<std::ptrdiff_t>(std::min(
                                        fault.position > 0 ? fault.position - 1 : 0, text.size()));
    return tl::unexpected(Error{
        ErrorCode::kDataDamaged,
        fmt::format(
            "{}:{}: not valid JSON at byte {}; look for a missing quote, comma or bracket there.",
            name, 1 + std::count(text.begin(), end, '\n'), fault.position)});
  }
  return Json::parse(text.begin(), text.end(), nullptr, false);
}

}  // namespace forewalk::rdw
