/// How finely a file can say where its vertices are.
#pragma once

#include <array>

#include "format/source/mesh.h"

namespace gigabake {

/// Largest magnitude of a coordinate on each of a mesh's own axes.
using LocalReach = std::array<float, 3>;

/// Largest distance in the scene between a vertex within `reach` and the next one that the file could say along one of
/// its axes: half of it is how far a vertex may be from where its author had it.
/// Exact   Floats: their spacing at the reach; quantized positions: their step; times the length that the instance's
/// map
///         gives the axis. What float32 translations of EXT_mesh_gpu_instancing lose is not in it.
double position_spacing_m(const Primitive& primitive, const Instance& instance, const LocalReach& reach);

}  // namespace gigabake
