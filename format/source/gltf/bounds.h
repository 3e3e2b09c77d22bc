/// Where a glTF stands, told by its JSON alone: no vertex is read.
#pragma once

#include "format/source/source.h"
#include "format/source/source_files.h"
#include "lattice/world_box.h"

namespace gigabake {

/// Bounds of a .glb, .gltf or .b3dm without a tile's transform: nodes, the turn to z up by tile.gltf_up, RTC_CENTER and
/// CESIUM_RTC are in them, as a tileset would have it. Vertices are where their accessors' `min` and `max` say; without
/// these they are taken to be at their node's origin.
/// Cost    Reads the headers and the JSON.
/// Errors  InputError: malformed in what is looked at. Nothing else is checked.
WorldBox gltf_bounds(const TileRef& tile, const SourceFiles& files);

}  // namespace gigabake
