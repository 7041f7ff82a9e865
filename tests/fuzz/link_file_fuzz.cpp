// The reader of link files on any bytes; what it accepts can be put on a graph.
#include "service/link_file.h"
#include "tests/fuzz/fuzz.h"

using forewalk::testing::require;
using forewalk::testing::requireSentence;
using forewalk::testing::seedsOf;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto links =
      forewalk::service::parseLinks({reinterpret_cast<const char*>(data), size}, "fuzz");
  if (links) {
    for (const auto& link : *links) {
      require(forewalk::navmesh::validate(link).has_value(), "a link is sound");
    }
    return 0;
  }
  requireSentence(links.error().message, "fuzz");
  return 0;
}

std::vector<std::vector<std::uint8_t>> seedCorpus() {
  return seedsOf({R"({"format": "forewalk.links/1", "links": []})",
                  R"({"format": "forewalk.links/1", "links": [{"id": 1, "name": "lift",
            "entry": [1, 0, 2.5], "exit": [1, 3, 2.5], "length": 4.0, "both_ways": true,
            "open": false}, {"id": 2, "entry": [0, 0, 0], "exit": [9, 0, 1e3], "length": 0}]})"});
}
