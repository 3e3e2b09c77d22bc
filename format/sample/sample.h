/// The project's own sample: a believable landscape of any size as 3D Tiles, and the same flat and local.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>

#include "lattice/frames.h"

namespace gigabake::sample {

/// A million tiles.
inline constexpr int max_sample_tiles = 1024;

struct SampleOptions {
  double size_m = 384;       ///< edge of the square map, 64 … 100000
  int tiles = 4;             ///< along an edge, 1 … max_sample_tiles
  double ground_step_m = 1;  ///< about: a tile has a whole number of steps
  double texel_m = 0.25;     ///< of the ground's pictures, about
  std::uint32_t seed = 1;
  Geodetic origin{46.9312, 8.3017, 610};
  int threads = 1;
};

struct SampleReport {
  std::uint64_t triangles = 0, bytes = 0;  ///< of the finest tiles of one variant; of all files
  std::uint32_t houses = 0, trees = 0, tiles = 0;
  std::array<double, 3> min_m{}, max_m{};  ///< east, north, up of the origin's tangent plane
};

/// Writes DIR/tileset.json with DIR/tiles/*.glb (georeferenced, one coarser level above the tiles, REPLACE) and
/// DIR/local/*.glb (the map's own flat frame, for --local); what houses and trees show stands once beside the tiles of
/// each, in textures/. More than 16 tiles along an edge stand in blocks of 16 × 16: each is a tileset of its own
/// (DIR/tiles/block_X_Y.json) with a coarser level of its own, and the outermost names the blocks. A former sample in
/// DIR is replaced as a whole. Exact   The same positions, pixels and indices for the same options on every machine;
/// threads do not show. The
///         same bytes where libjpeg and zlib are the same: how tightly they pack is theirs to decide.
/// Errors  UsageError for options out of range; InputError where DIR holds something else or cannot be written.
SampleReport write_sample(const std::filesystem::path& dir, const SampleOptions& options);

}  // namespace gigabake::sample
