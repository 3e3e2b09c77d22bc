/// Frame statistics as JSON.
#pragma once

#include <nlohmann/json.hpp>

#include "viewer/pictures/frame_renderer.h"

namespace gigabake {

/// Returns every member of FrameStats by its name; bytes_allowed is null if unbounded.
nlohmann::ordered_json to_json(const FrameStats& stats);

}  // namespace gigabake
