/// Reader of glTF content files: triangles, materials and encoded images.
#pragma once

#include <filesystem>

#include "format/source/mesh.h"
#include "format/source/source.h"

namespace gigabake {

/// Reads a content file of any format that contains glTF, as read_tile() does.
TileMesh read_gltf(const TileRef& tile, const std::filesystem::path& root, ReadScope scope, const PrimitiveSink& sink,
                   const ThreadPool& pool);

}  // namespace gigabake
