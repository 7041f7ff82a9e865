// What every reader of other people's text needs: its lines, and a way to quote it in a message.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace forewalk {

/// In double quotes, printable ASCII, at most 40 characters, whatever bytes the piece has.
inline std::string inQuotes(std::string_view text) {
  constexpr std::size_t kShown = 40;
  std::string shown = "\"";
  for (const char c : text.substr(0, kShown)) shown += c >= ' ' && c <= '~' ? c : '?';
  shown += text.size() > kShown ? "...\"" : "\"";
  return shown;
}

/// What editors on Windows put before UTF-8 is no part of the text.
inline std::string_view withoutByteOrderMark(std::string_view text) {
  constexpr std::string_view kMark = "\xEF\xBB\xBF";
  return text.substr(text.substr(0, kMark.size()) == kMark ? kMark.size() : 0);
}

/// Hands out the lines of a text without their ends (LF or CRLF). Views into the text.
class Lines {
 public:
  explicit Lines(std::string_view text) : rest_(text) {}

  /// False where there is no line left; a text that ends with a line end has none after it.
  bool next(std::string_view& line) {
    if (rest_.empty()) return false;
    const std::size_t end = rest_.find('\n');
    line = rest_.substr(0, end);
    rest_.remove_prefix(end == std::string_view::npos ? rest_.size() : end + 1);
    if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
    ++number_;
    return true;
  }

  std::size_t number() const { return number_; }   ///< of the last line, from 1
  std::string_view rest() const { return rest_; }  ///< what follows the last line

 private:
  std::string_view rest_;
  std::size_t number_ = 0;
};

}  // namespace forewalk
