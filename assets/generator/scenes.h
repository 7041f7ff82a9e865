// The bundled scenes and their scenarios, as files to be written.
#pragma once

#include <string>
#include <vector>

namespace forewalk::assets {

struct File {
  std::string path;  ///< below assets/, for example "scenes/office.obj"
  std::string text;
};

/// Five scenes and a scenario for each; the same bytes every time.
std::vector<File> generateScenes();

}  // namespace forewalk::assets
