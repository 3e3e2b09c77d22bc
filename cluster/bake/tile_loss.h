/// Losses of tiles that cannot be read.
#pragma once

#include <string>

#include "format/scene/xml/scene_xml.h"

namespace gigabake {

/// Returns a loss's reason without the file name that it begins with, if that file is the tile that the loss names. A
/// message then names the file once. Otherwise returns an empty text.
std::string reason_without_tile(const SceneLoss& loss);

}  // namespace gigabake
