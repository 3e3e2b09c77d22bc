/// A frame's statistics for programs.
#pragma once

#include <nlohmann/json.hpp>

#include "viewer/pictures/frame_renderer.h"

namespace gigabake {

/// Every member of FrameStats by its name; bytes_allowed is null where there is no bound.
nlohmann::ordered_json to_json(const FrameStats& stats);

}  // namespace gigabake
