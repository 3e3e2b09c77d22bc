/// JSON messages between a browser page and the server.
#pragma once

#include <string>
#include <string_view>

#include "viewer/live/live_scene.h"

namespace gigabake {

/// Parses the JSON object of one user input; docs/viewer.md lists its members.
/// Errors  InputError: not JSON, or a member that is unknown, of a wrong type or out of range.
ViewerInput viewer_input_from_json(std::string_view text);

/// Returns a viewer's state and the statistics of its last frame as one JSON object; frame may be nullptr.
std::string to_json(const ViewerState& state, const LiveFrame* frame);

/// Returns the point as JSON; {"point": null} if `point` is nullopt.
std::string to_json(const std::optional<PickedPoint>& point);

/// Returns the facts as JSON; {"cell": null} if `facts` is nullopt.
std::string to_json(const std::optional<CellFacts>& facts);

}  // namespace gigabake
