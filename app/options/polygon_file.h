/// A mesh file whose triangles stand among the voxels of a picture.
#pragma once

#include <filesystem>
#include <memory>

#include "viewer/pictures/polygons.h"

namespace gigabake::app {

/// Any mesh file that a bake reads. Its coordinates are scene metres, y up in glTF as ever; colours and textures as a
/// bake takes them. Errors  InputError: not to be read; no triangles.
std::shared_ptr<const PolygonMesh> read_polygons(const std::filesystem::path& file, int threads);

}  // namespace gigabake::app
