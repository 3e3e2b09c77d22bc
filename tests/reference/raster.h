/// The coverage of voxels along each axis, in plain code. It is the reference for levels that are filtered by view.
#pragma once

#include <array>
#include <cmath>
#include <map>
#include <vector>

#include "bake_scene.h"
#include "core/math/octahedral.h"

namespace gigabake::reference {

/// Coverage of a voxel along each axis, in cells of the plane of the other two axes. The lower of these axes varies
/// fastest.
struct Raster {
  int edge = 1;
  std::array<std::vector<int>, 3> cells;
  int at(int axis, int u, int v) const { return cells[std::size_t(axis)][std::size_t(u + edge * v)]; }
};
using Rasters = std::map<Voxel, Raster>;

inline Raster blank_raster(int edge) {
  Raster r;
  r.edge = edge;
  for (auto& cells : r.cells) cells.assign(std::size_t(edge * edge), 0);
  return r;
}

/// Returns the coverage of a voxel of lod 0 along an axis. A translucent voxel is part of a layer with a normal n, |x|
/// + |y| + |z| = 1. The layer crosses 1/|n[axis]| voxels of a column on average, and together these voxels cover as
/// much as the layer.
inline int coverage_of(const BakedVoxel& v, int axis) {
  if (v.rgba[3] == 255) return 255;
  double n[3];
  decode_octahedral(v.normal.data(), n);
  const double part = std::abs(n[axis]) / (std::abs(n[0]) + std::abs(n[1]) + std::abs(n[2]));
  return int(std::floor(255 * (1 - std::pow(1 - v.rgba[3] / 255.0, part)) + 0.5));
}

inline Rasters rasters_of_finest(const VoxelMap& voxels) {
  Rasters out;
  for (const auto& [p, v] : voxels) {
    Raster r = blank_raster(1);
    for (int axis = 0; axis < 3; ++axis) r.cells[std::size_t(axis)][0] = coverage_of(v, axis);
    out[p] = r;
  }
  return out;
}

}  // namespace gigabake::reference
