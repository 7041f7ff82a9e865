// generate_scenes OUTDIR: writes the bundled scenes and scenarios below OUTDIR (in the repository:
// assets).
#include <cstdio>
#include <exception>
#include <filesystem>
#include <fstream>

#include "scenes.h"

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: generate_scenes OUTDIR\n");
    return 2;
  }
  try {
    for (const auto& file : forewalk::assets::generateScenes()) {
      const std::filesystem::path path = std::filesystem::path(argv[1]) / file.path;
      std::filesystem::create_directories(path.parent_path());
      std::ofstream out(path, std::ios::binary);
      out << file.text;
      out.flush();
      if (!out) {
        std::fprintf(stderr, "%s: could not be written. Is the disk full or read-only?\n",
                     path.c_str());
        return 1;
      }
      std::printf("%s: %zu bytes\n", path.c_str(), file.text.size());
    }
  } catch (const std::exception& error) {
    std::fprintf(stderr, "generate_scenes: %s\n", error.what());
    return 1;
  }
}
