// The reader of link files on any bytes; what it accepts can be put on a graph.
#include <cstdio>
#include <cstdlib>
#include <string_view>

#include "service/link_file.h"
#include "tests/fuzz/fuzz.h"

namespace {

void require(bool promise, const char* what) {
  if (promise) return;
  std::fprintf(stderr, "broken promise: %s\n", what);
  std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto links =
      forewalk::service::parseLinks({reinterpret_cast<const char*>(data), size}, "fuzz");
  if (links) {
    for (const auto& link : *links) {
      require(forewalk::navmesh::validate(link).has_value(), "a link is sound");
    }
    return 0;
  }
  const std::string& message = links.error().message;
  require(message.starts_with("fuzz") && message.size() < 600,
          "a message says where, and is short");
  for (const char c : message) require(c >= ' ' && c <= '~', "a message is printable");
  return 0;
}

std::vector<std::vector<std::uint8_t>> seedCorpus() {
  std::vector<std::vector<std::uint8_t>> seeds;
  for (const std::string_view text :
       {std::string_view(R"({"format": "forewalk.links/1", "links": []})"),
        std::string_view(R"({"format": "forewalk.links/1", "links": [{"id": 1, "name": "lift",
            "entry": [1, 0, 2.5], "exit": [1, 3, 2.5], "length": 4.0, "both_ways": true,
            "open": false}, {"id": 2, "entry": [0, 0, 0], "exit": [9, 0, 1e3], "length": 0}]})")}) {
    seeds.emplace_back(text.begin(), text.end());
  }
  return seeds;
}
