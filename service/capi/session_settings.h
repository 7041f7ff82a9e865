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

/// What is given (null: defaults), and what it comes to: FOREWALK_OK, or the refusal of a form that
/// cannot be read or of a tracked space.
forewalk_status readSession(const forewalk_session_settings* given,
                            forewalk_session_settings& known, rdw::SessionSettings& ours);

/// A place of the virtual floor and a heading, in the session's axes.
rdw::VirtualStart startFrom(forewalk_axes axes, forewalk_vec3 floor, float heading);

/// The name of a constant that was checked.
std::string_view controllerName(forewalk_controller controller);

}  // namespace forewalk::capi
