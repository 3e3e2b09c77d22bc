/// The project's own sample: a synthetic landscape of any size as 3D Tiles, georeferenced and in a flat local frame.
#pragma once

#include <cstdint>
#include <filesystem>

#include "core/math/frames.h"
#include "core/math/vec3.h"

namespace gigabake::sample {

/// Max tiles along an edge: one million tiles.
inline constexpr int max_sample_tiles = 1024;

struct SampleOptions {
  double size_m = 384;       ///< edge of the square map in metres, 64 … 100000
  int tiles = 4;             ///< along an edge, 1 … max_sample_tiles
  double ground_step_m = 1;  ///< approximate: a tile has a whole number of steps
  double texel_m = 0.25;     ///< approximate texel size of the ground's images
  std::uint32_t seed = 1;
  Geodetic origin{46.9312, 8.3017, 610};
  int threads = 1;
};

struct SampleReport {
  std::uint64_t triangles = 0, bytes = 0;  ///< triangles of the finest tiles in one frame; bytes of all files
  std::uint32_t houses = 0, trees = 0, tiles = 0;
  Vec3d min_m{}, max_m{};  ///< east, north, up of the origin's tangent plane
};

/// Writes DIR/tileset.json with DIR/tiles/*.glb and DIR/local/*.glb. The tiles in tiles/ are georeferenced, and a
/// coarser level above them is refined by REPLACE. The tiles in local/ are in the map's own flat frame, for --local.
/// Images of houses and trees are stored once per frame, in tiles/textures/ and local/textures/.
/// Samples of more than 16 tiles along an edge have blocks of 16 × 16 tiles. Each block is a tileset
/// (DIR/tiles/block_X_Y.json) with a separate coarser level; the root tileset refers to the blocks. Remains of a killed
/// run in DIR are replaced.
/// Exact   Same positions, pixels and indices for the same options on every machine and for any number of threads. Same
///         bytes for the same versions of libjpeg and zlib.
/// Errors  UsageError for options out of range; InputError if DIR has a sample or other content, or is not writable.
SampleReport write_sample(const std::filesystem::path& dir, const SampleOptions& options);

}  // namespace gigabake::sample
