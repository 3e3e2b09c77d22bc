/// Frame statistics as JSON.
#pragma once

#include <nlohmann/json.hpp>

#include "viewer/pictures/frame_renderer.h"

namespace gigabake {

/// Returns the members of FrameStats except `starved`, by their names; bytes_allowed is null if unbounded.
nlohmann::ordered_json to_json(const FrameStats& stats);

}  // namespace gigabake
