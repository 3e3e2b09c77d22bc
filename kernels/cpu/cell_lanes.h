/// The CPU's way to run kernels/body/coverage.h and surface.h: the cells of a slab side by side, one a vector lane.
#pragma once

#include "kernels/body/coverage.h"
#include "kernels/body/surface.h"

namespace gigabake::kernels {

inline constexpr int lane_group = 4;

/// Up to 64 cells of one slab. Lanes beyond `count` up to the next multiple of lane_group are computed and ignored.
struct CellLanes {
  /// In: the cell's lowest corner, voxels from the anchor. After the last cell there is room for a group of zeros.
  alignas(64) double u[64 + lane_group], v[64 + lane_group];
  alignas(64) double area[64], moment_u[64], moment_v[64];        ///< out: as CellMoments
  alignas(64) float moment_uu[64], moment_uv[64], moment_vv[64];  ///< out of measure_second_moments()
  int count = 0;
};

/// Exact  The same bits as add_edge() called cell by cell, whatever the processor.
void measure_areas(const TrianglePlane& plane, const SlabPolygon& polygon, CellLanes& lanes);
void measure_moments(const TrianglePlane& plane, const SlabPolygon& polygon, CellLanes& lanes);
void measure_second_moments(const TrianglePlane& plane, const SlabPolygon& polygon, CellLanes& lanes);

}  // namespace gigabake::kernels
