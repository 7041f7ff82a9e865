// --method, wherever a command makes prediction graphs.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "prediction/prediction_graph.h"

namespace forewalk::cli {

/// As people and files call it.
inline std::string nameOf(prediction::Method method) {
  return method == prediction::Method::kFront ? "front" : "polygon";
}

/// Reads "polygon" or "front" into `method`, which lives as long as `verb` is parsed.
inline CLI::Option* addMethodOption(CLI::App& verb, prediction::Method& method) {
  return verb
      .add_option_function<std::string>(
          "--method",
          [&method](const std::string& name) {
            method = name == nameOf(prediction::Method::kFront) ? prediction::Method::kFront
                                                                : prediction::Method::kPolygon;
          },
          "How graphs are made. polygon: the paper's graph, polygon by polygon; front: real "
          "junctions, found by following the front of all points at one distance")
      ->check(
          CLI::IsMember({nameOf(prediction::Method::kPolygon), nameOf(prediction::Method::kFront)}))
      ->default_str(nameOf(method));
}

}  // namespace forewalk::cli
