/// A glTF content file as triangles, materials and encoded images.
#pragma once

#include <filesystem>

#include "format/source/mesh.h"
#include "format/source/source.h"

namespace gigabake {

/// As read_tile(), for every kind of content that holds glTF.
TileMesh read_gltf(const TileRef& tile, const std::filesystem::path& root, ReadScope scope, const PrimitiveSink& sink);

}  // namespace gigabake
