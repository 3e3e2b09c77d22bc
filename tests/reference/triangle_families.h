/// Random triangles by family. Each family tests one possible error in deciding whether a triangle overlaps a voxel.
#pragma once

#include <random>

#include "bench/exact/exact_clip.h"

namespace gigabake::reference {

using Rng = std::mt19937_64;

enum class Family {
  tiny,                 ///< much smaller than a voxel, near voxel faces and corners
  small,                ///< up to two voxels, anywhere
  sliver,               ///< long and at most a few sub-voxels wide
  lattice_vertices,     ///< every vertex on a voxel corner
  half_voxel_ties,      ///< every coordinate a multiple of half a voxel: centres and corners
  axis_parallel,        ///< in a plane x, y or z = constant
  in_lattice_plane,     ///< in a plane x, y or z = 256k
  edge_through_corner,  ///< an edge passes exactly through a voxel corner
  diagonal_plane,       ///< in a plane such as x + y + z = 256k or x = y, which passes through corners and edges
  large,                ///< a million voxels wide, seen through a small window
  large_lattice,        ///< like `large`, with every vertex on a voxel corner
};

inline constexpr Family all_families[] = {Family::tiny,
                                          Family::small,
                                          Family::sliver,
                                          Family::lattice_vertices,
                                          Family::half_voxel_ties,
                                          Family::axis_parallel,
                                          Family::in_lattice_plane,
                                          Family::edge_through_corner,
                                          Family::diagonal_plane,
                                          Family::large,
                                          Family::large_lattice};

const char* name_of(Family family);

/// Returns a random triangle with area near the window's middle.
Triangle random_triangle(Family family, const Window& window, Rng& rng);

std::int64_t uniform(Rng& rng, std::int64_t low, std::int64_t high);  ///< both bounds inclusive

}  // namespace gigabake::reference
