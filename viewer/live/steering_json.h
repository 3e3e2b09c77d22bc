/// What a browser's page says, and what it is told.
#pragma once

#include <string>
#include <string_view>

#include "viewer/live/live_scene.h"

namespace gigabake {

/// One object; docs/viewer.md lists its members.
/// Errors  InputError: not JSON, or a member that is unknown, of another type or out of range.
Steering steering_from_json(std::string_view text);

/// A viewer's state and the numbers of its last frame; frame may be nullptr. One JSON object.
std::string to_json(const ViewerState& state, const LiveFrame* frame);

/// {"point": null} where there is none.
std::string to_json(const std::optional<PickedPoint>& point);

}  // namespace gigabake
