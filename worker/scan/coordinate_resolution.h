/// Resolution of a file's vertex coordinates.
#pragma once

#include <array>

#include "format/source/mesh.h"

namespace gigabake {

/// Max magnitude of a coordinate on each of a mesh's own axes.
using CoordinateRange = std::array<float, 3>;

/// Returns the max distance in the scene, within `reach`, between neighbouring representable coordinates on one axis. A
/// vertex may be off by half of it.
/// Exact   Float coordinates: their spacing (ULP) at the reach. Quantized coordinates: their step. Both are scaled by
///         the instance's transform of the axis. The error of float32 translations in EXT_mesh_gpu_instancing is not
///         included.
double coordinate_resolution_m(const Primitive& primitive, const Instance& instance, const CoordinateRange& reach);

}  // namespace gigabake
