/// Bounds of a glTF document, read from its JSON without any vertices.
#pragma once

#include "core/math/world_box.h"
#include "format/source/source.h"
#include "format/source/source_files.h"

namespace gigabake {

/// Returns the bounds of a .glb, .gltf or .b3dm without its tile's transform. They include the transforms of nodes, the
/// rotation to z up by tile.gltf_up, RTC_CENTER and CESIUM_RTC, as bounds in a tileset do. The bounds of vertices are
/// `min` and `max` of their accessor; if these are missing, the origin of the node is used.
/// Cost    Reads the headers and the JSON.
/// Errors  InputError: a member that the bounds depend on is malformed. No other member is checked.
WorldBox gltf_bounds(const TileRef& tile, const SourceFiles& files);

}  // namespace gigabake
