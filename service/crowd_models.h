// The avoidance models by name, each with the parameters that a file may set.
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <string_view>

#include "agents/model.h"
#include "rdw/json_fields.h"

namespace forewalk::service {

using ModelMaker = std::function<std::unique_ptr<const agents::Model>()>;

struct RegisteredModel {
  std::string_view name;  ///< in files
  /// Reads the parameters that are present, the others keep their defaults; the maker gives as many
  /// models as are asked for. `fields` null: all defaults.
  ModelMaker (*read)(rdw::Fields* fields);
};

/// orca, social-forces, hrvo, caacd. A new model adds an entry.
std::span<const RegisteredModel> registeredModels();

}  // namespace forewalk::service
