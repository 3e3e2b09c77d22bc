/// The vectorized CPU version of kernels/body/voxelize/coverage.h and surface.h: each vector lane computes one cell,
/// which is a voxel of the slab.
#pragma once

#include "kernels/body/voxelize/coverage.h"
#include "kernels/body/voxelize/surface.h"
#include "kernels/cpu/voxelize/lanes.h"

namespace gigabake::kernels {

/// The cells of one slab, at most 64. Lanes from `count` to the next multiple of lane_group are computed and ignored.
struct CellLanes {
  /// The input: the lowest corner of each cell, in voxels from the triangle's anchor. The arrays have space for one
  /// group of zeros at their end.
  alignas(64) double u[64 + lane_group], v[64 + lane_group];
  alignas(64) double area[64], moment_u[64], moment_v[64];        ///< output: the members of CellMoments
  alignas(64) float moment_uu[64], moment_uv[64], moment_vv[64];  ///< output of measure_second_moments()
  int count = 0;
};

/// Computes the areas of all cells. measure_moments() also computes first moments; measure_second_moments() also
/// computes first and second moments.
/// Exact   The same bits as add_edge() called per cell, on all processors.
void measure_areas(const TrianglePlane& plane, const SlabPolygon& polygon, CellLanes& lanes);
void measure_moments(const TrianglePlane& plane, const SlabPolygon& polygon, CellLanes& lanes);
void measure_second_moments(const TrianglePlane& plane, const SlabPolygon& polygon, CellLanes& lanes);

}  // namespace gigabake::kernels
