/// Losses that are tiles which cannot be read.
#pragma once

#include <string>

#include "format/scene/scene_xml.h"

namespace gigabake {

/// Returns a loss's reason without the file that it begins with, where that is the tile that the loss names: a message
/// names a file once. Else returns an empty text.
std::string reason_without_tile(const SceneLoss& loss);

}  // namespace gigabake
