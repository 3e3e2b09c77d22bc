/// The levels of a mesh: fewer and fewer triangles of the same vertices, with their errors.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "kernels/marching/cast_camera.h"
#include "worker/scan/source_triangles.h"

namespace gigabake::bench {

struct MeshLevel {
  std::vector<std::uint32_t> index;  ///< 3 per triangle
  double error = 0;                  ///< distance from the source's surface in lod-0 voxels
};

/// The levels of one part of a source, finest first. The first level is the part itself, without error.
struct MeshLevels {
  TriangleBox box;
  std::vector<MeshLevel> levels;
};

/// Returns true if gigabake was built with meshoptimizer.
bool has_mesh_levels();

/// Simplifies a part to half of the triangles again and again, each time from the source. Ends where meshoptimizer
/// removes few more triangles. Open edges stay, so that levels of adjacent parts have no gap between them. Vertices
/// with equal attributes are merged before.
/// Errors  UsageError: built without meshoptimizer.
MeshLevels make_mesh_levels(const SourceTriangles& source, std::size_t part);

/// Returns the width of a pixel at a distance from the eye. A surface that moves by less moves by less than one pixel
/// in the middle of the image.
double pixel_width(const kernels::CastCamera& camera, double distance);

/// Returns the coarsest level whose error is at most `max_pixels` pixels at the nearest point of the box. Returns
/// nullopt if the whole box is behind the eye.
std::optional<std::size_t> choose_level(const MeshLevels& mesh, const kernels::CastCamera& camera, double max_pixels);

}  // namespace gigabake::bench
