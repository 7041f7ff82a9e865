// A session's settings: the C caller's, checked, and ours.
#pragma once

#include <string_view>
#include <tl/expected.hpp>

#include "navmesh/error.h"
#include "rdw/session.h"
#include "service/capi/forewalk.h"
#include "service/capi/space_handle.h"

namespace forewalk::capi {

forewalk_session_settings defaultSessionSettings();

/// FOREWALK_OK, or the refusal of what cannot even be read.
forewalk_status checkForm(const forewalk_session_settings& settings);

/// Of settings whose form was checked. Fails as TrackedSpace does.
tl::expected<rdw::SessionSettings, Error> sessionSettings(
    const forewalk_session_settings& settings);

/// A place of the virtual floor and a heading, in the session's axes.
rdw::VirtualStart startFrom(forewalk_axes axes, forewalk_vec3 floor, float heading);

/// The name of a constant that was checked.
std::string_view controllerName(forewalk_controller controller);

}  // namespace forewalk::capi
