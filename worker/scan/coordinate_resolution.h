/// Resolution of a file's vertex coordinates.
#pragma once

#include "core/math/vec3.h"
#include "format/source/mesh.h"

namespace gigabake {

/// Max magnitude of a mesh's coordinates on each axis of its local frame.
using CoordinateRange = Vec3<float>;

/// Returns the max distance between adjacent representable coordinates on one axis, in scene metres, for coordinates up
/// to `extent`. A vertex may be off by half of this distance.
/// Exact   For float coordinates, the local distance is the ULP at `extent`; for quantized coordinates, it is their
///         step. It is multiplied by the scale of the instance's transform on the axis. The error of float32
///         translations in EXT_mesh_gpu_instancing is not included.
double coordinate_resolution_m(const Primitive& primitive, const Instance& instance, const CoordinateRange& extent);

}  // namespace gigabake
