// The fields of JSON objects that people write: read with their ranges, refused with where and why.
#pragma once

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "navmesh/build/scene.h"
#include "navmesh/build/settings.h"
#include "navmesh/error.h"
#include "navmesh/file_text.h"

namespace forewalk::rdw {

using Json = nlohmann::json;

inline constexpr double kDegree = 3.14159265358979323846 / 180.0;  ///< radians

/// The first thing that is wrong; what is found after it stays unsaid.
class Problem {
 public:
  explicit Problem(std::string file) : file_(std::move(file)) {}

  void say(ErrorCode code, const std::string& sentence) {
    if (!error_) error_ = Error{code, fmt::format("{}: {}", file_, sentence)};
  }
  void pass(const Error& error) { say(error.code, error.message); }
  const std::optional<Error>& error() const { return error_; }

 private:
  std::string file_;
  std::optional<Error> error_;
};

/// "did you mean ...?" where one of `known` is near to what was written, else all of them.
std::string suggestion(std::string_view wrong, std::span<const std::string_view> known);

/// Reads the fields of one object and knows which have been asked for.
class Fields {
 public:
  /// `path` is "" for the whole file, else ends in a dot. `place` is for refusing unknown names.
  Fields(const Json& object, std::string path, Problem& problem, std::string_view place = "here")
      : object_(object), path_(std::move(path)), problem_(problem), place_(place) {
    if (!object_.is_object()) {
      problem_.say(ErrorCode::kDataDamaged,
                   fmt::format("{} has to be an object {{...}}.",
                               path_.empty() ? "the file" : path_.substr(0, path_.size() - 1)));
    }
  }

  /// The field, or null where it is absent. Makes the name a known one.
  const Json* find(std::string_view name) {
    known_.push_back(name);
    if (!object_.is_object()) return nullptr;
    const auto found = object_.find(std::string(name));
    return found == object_.end() ? nullptr : &*found;
  }

  bool has(std::string_view name) const {
    return object_.is_object() && object_.contains(std::string(name));
  }

  /// Reads a number in [low, high], times `scale`, where the field is present.
  template <typename Real>
  void number(std::string_view name, double low, double high, Real& value, double scale = 1.0) {
    const Json* field = find(name);
    if (field == nullptr) return;
    if (!field->is_number()) return wrongKind(name, "a number");
    const double read = field->get<double>();
    if (!(read >= low && read <= high)) {
      return problem_.say(ErrorCode::kSettingOutOfRange,
                          fmt::format("{}{} is {:.6g}, it has to lie in [{:.6g}, {:.6g}].", path_,
                                      name, read, low, high));
    }
    value = static_cast<Real>(read * scale);
  }

  template <typename Integer>
  void integer(std::string_view name, std::uint64_t low, std::uint64_t high, Integer& value) {
    const Json* field = find(name);
    if (field == nullptr) return;
    if (!field->is_number_unsigned()) return wrongKind(name, "a whole number, 0 or more");
    const std::uint64_t read = field->get<std::uint64_t>();
    if (read < low || read > high) {
      return problem_.say(
          ErrorCode::kSettingOutOfRange,
          fmt::format("{}{} is {}, it has to lie in [{}, {}].", path_, name, read, low, high));
    }
    value = static_cast<Integer>(read);
  }

  void boolean(std::string_view name, bool& value) {
    const Json* field = find(name);
    if (field == nullptr) return;
    if (!field->is_boolean()) return wrongKind(name, "true or false");
    value = field->get<bool>();
  }

  void text(std::string_view name, std::string& value) {
    const Json* field = find(name);
    if (field == nullptr) return;
    if (!field->is_string()) return wrongKind(name, "text in quotes");
    value = field->get<std::string>();
  }

  /// Reads one of `words`; `value` stays where the field is absent. Index of the word.
  void word(std::string_view name, std::span<const std::string_view> words, std::size_t& value) {
    const Json* field = find(name);
    if (field == nullptr) return;
    if (!field->is_string())
      return wrongKind(name, fmt::format("one of {}", fmt::join(words, ", ")));
    const std::string& read = field->get_ref<const std::string&>();
    const auto found = std::find(words.begin(), words.end(), read);
    if (found == words.end()) {
      return problem_.say(ErrorCode::kDataDamaged,
                          fmt::format("{}{} is {}, which is not known; {}", path_, name,
                                      inQuotes(read), suggestion(read, words)));
    }
    value = static_cast<std::size_t>(found - words.begin());
  }

  /// Reads a list of `count` finite numbers within 100 km. Whether it is present and sound.
  bool coordinates(std::string_view name, std::size_t count, std::vector<double>& values) {
    const Json* field = find(name);
    return field != nullptr && coordinates(*field, fmt::format("{}{}", path_, name), count, values);
  }

  bool coordinates(const Json& list, const std::string& what, std::size_t count,
                   std::vector<double>& values) {
    values.clear();
    if (list.is_array() && list.size() == count) {
      for (const Json& value : list) {
        if (value.is_number() && std::abs(value.get<double>()) <= 1e5)
          values.push_back(value.get<double>());
      }
    }
    if (values.size() == count) return true;
    problem_.say(ErrorCode::kDataDamaged,
                 fmt::format("{} has to be {} numbers [{}], metres, within 100 km.", what, count,
                             count == 2 ? "x, z" : "x, y, z"));
    return false;
  }

  void wrongKind(std::string_view name, std::string_view kind) {
    problem_.say(ErrorCode::kDataDamaged, fmt::format("{}{} has to be {}.", path_, name, kind));
  }

  const std::string& path() const { return path_; }
  Problem& problem() { return problem_; }

  /// Refuses what nobody asked for.
  void finish() {
    if (!object_.is_object()) return;
    for (const auto& [key, value] : object_.items()) {
      if (std::find(known_.begin(), known_.end(), key) != known_.end()) continue;
      problem_.say(ErrorCode::kDataDamaged,
                   fmt::format("{} is not known {}; {}", inQuotes(path_ + key), place_,
                               suggestion(key, known_)));
    }
  }

 private:
  const Json& object_;
  std::string path_;
  Problem& problem_;
  std::string_view place_;
  std::vector<std::string_view> known_;
};

/// Refuses a file whose field "format" is not `format`.
void requireFormat(Fields& file, std::string_view format);

/// Reads the parts "import" and "build" of a file that names a scene (simulation_config.h).
void readImport(Fields& file, navmesh::ImportSettings& import);
void readBuild(Fields& file, navmesh::BuildSettings& build);

}  // namespace forewalk::rdw
