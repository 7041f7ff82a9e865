// Lets a libFuzzer program write its seeds: `scene_fuzz --write-seeds=DIR`.
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>

#include "tests/fuzz/fuzz.h"

extern "C" int LLVMFuzzerInitialize(int* argc, char*** argv) {
  constexpr std::string_view kFlag = "--write-seeds=";
  for (int i = 1; i < *argc; ++i) {
    const std::string_view argument = (*argv)[i];
    if (!argument.starts_with(kFlag)) continue;
    const std::filesystem::path folder(argument.substr(kFlag.size()));
    std::filesystem::create_directories(folder);
    std::size_t number = 0;
    for (const std::vector<std::uint8_t>& seed : seedCorpus()) {
      std::ofstream out(folder / ("seed-" + std::to_string(number++)), std::ios::binary);
      out.write(reinterpret_cast<const char*>(seed.data()),
                static_cast<std::streamsize>(seed.size()));
    }
    std::exit(0);
  }
  return 0;
}
