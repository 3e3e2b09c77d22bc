/// The window of a cell in the form that kernels use. A window is the cube of voxels that is baked.
///
/// Space   Sub-voxels from the window's lowest corner; bricks by Morton key, 0 … 2^(3 levels) − 1.
#pragma once

#include <bit>
#include <cstdint>

#include "core/base/host_device.h"
#include "core/base/rules.h"
#include "core/math/snap.h"
#include "core/math/vec3.h"
#include "core/octree/brick.h"
#include "kernels/body/cell.h"

namespace gigabake::kernels {

/// Number of levels of the largest window, which has 8192 voxels along its edge.
inline constexpr int max_levels = 11;

/// Lattice frame to which vertices are snapped.
struct SnapWindow {
  SnapFrame frame;
  Vec3i64 min;  ///< the window's lowest corner, lod-0 voxels
};

struct CellWindow : SnapWindow {
  std::int64_t edge;    ///< length of an edge, sub-voxels
  std::int32_t bricks;  ///< number of bricks along an edge
  int levels;           ///< log2(bricks); a cell has one more lod
  SurfaceRule rule;
};

/// Returns the number of bits of a brick's Morton code.
GB_HD int key_bits(const CellWindow& window) { return 3 * window.levels; }

inline CellWindow window_of(const CellParameters& p) {
  CellWindow w;
  w.frame = p.frame;
  w.min = p.window_min;
  w.edge = std::int64_t(p.window_voxels) * subvoxels;
  w.bricks = std::int32_t(p.window_voxels / brick_edge);
  w.levels = std::bit_width(std::uint32_t(w.bricks)) - 1;
  w.rule = p.surface;
  return w;
}

}  // namespace gigabake::kernels
