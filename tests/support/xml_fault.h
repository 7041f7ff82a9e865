// Whether what we draw is XML at all.
#pragma once

#include <cctype>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace forewalk::testing {

// Why `text` is not well-formed XML of the plain kind we write (no entities of our own, no CDATA),
// or nothing. Small on purpose: tags that nest and close, attributes once and quoted, no stray < or
// &.
inline std::string faultOf(std::string_view text) {
  std::vector<std::string> open;
  std::size_t i = 0, roots = 0;
  const auto nameAt = [&](std::size_t& at) {
    std::string name;
    while (at < text.size() && (std::isalnum(static_cast<unsigned char>(text[at])) != 0 ||
                                text[at] == ':' || text[at] == '-' || text[at] == '_')) {
      name += text[at++];
    }
    return name;
  };
  const auto knownEntity = [&](std::size_t at) {
    for (const std::string_view entity : {"&amp;", "&lt;", "&gt;", "&quot;", "&apos;"}) {
      if (text.substr(at, entity.size()) == entity) return true;
    }
    return false;
  };
  if (text.substr(0, 5) == "<?xml") i = text.find("?>") + 2;
  while (i < text.size()) {
    if (text[i] == '&' && !knownEntity(i)) return "stray & at byte " + std::to_string(i);
    if (text[i] != '<') {
      if (open.empty() && std::isspace(static_cast<unsigned char>(text[i])) == 0) {
        return "text outside the root at byte " + std::to_string(i);
      }
      ++i;
      continue;
    }
    ++i;
    if (text[i] == '/') {
      ++i;
      const std::string name = nameAt(i);
      if (open.empty() || open.back() != name) return name + " closes nothing";
      open.pop_back();
      if (i >= text.size() || text[i] != '>') return name + " has a closing tag that does not end";
      ++i;
      continue;
    }
    const std::string name = nameAt(i);
    if (name.empty()) return "stray < at byte " + std::to_string(i);
    if (open.empty() && ++roots > 1) return "a second root";
    std::set<std::string> attributes;
    for (;;) {
      while (i < text.size() && std::isspace(static_cast<unsigned char>(text[i])) != 0) ++i;
      if (i >= text.size()) return name + " does not end";
      if (text[i] == '>') {
        open.push_back(name);
        ++i;
        break;
      }
      if (text.substr(i, 2) == "/>") {
        i += 2;
        break;
      }
      std::size_t at = i;
      std::string attribute = nameAt(at);
      while (at < text.size() && text[at] == '.') {  // attr.name, yfiles.type
        ++at;
        attribute += '.';
        attribute += nameAt(at);
      }
      i = at;
      if (attribute.empty() || text.substr(i, 2) != "=\"") return name + " has no proper attribute";
      if (!attributes.insert(attribute).second) return name + " has " + attribute + " twice";
      for (i += 2; i < text.size() && text[i] != '"'; ++i) {
        if (text[i] == '<' || (text[i] == '&' && !knownEntity(i))) return "bad " + attribute;
      }
      ++i;
    }
  }
  if (!open.empty()) return open.back() + " is not closed";
  return roots == 1 ? "" : "no root";
}

}  // namespace forewalk::testing
