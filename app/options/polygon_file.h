/// Reader of a mesh file whose triangles are rendered together with the voxels.
#pragma once

#include <filesystem>
#include <memory>

#include "viewer/pictures/polygons.h"

namespace gigabake::app {

/// Reads any mesh file that a bake reads. The file's coordinates are scene metres; glTF is y up. Colours and textures
/// are read as in a bake.
/// Errors  InputError: the file cannot be read, or has no triangles.
std::shared_ptr<const PolygonMesh> read_polygons(const std::filesystem::path& file, int threads);

}  // namespace gigabake::app
