/// Savings and errors of normals with fewer bits: the shards of a bake are written again with coarser normals.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <vector>

#include "lattice/rules.h"

namespace gigabake::bench {

struct NormalBits {
  int bits = 16;                           ///< of both octahedral axes together
  double sphere_deg = 0, largest_deg = 0;  ///< of directions all over the sphere: mean and max angle
  double mean_deg = 0, most_deg = 0;       ///< scene's lod 0, relative to 16 bits: mean, and 99 % are below
  std::uint64_t bytes = 0;                 ///< of all shards
  double lit_flip = 0;                     ///< mean FLIP of lit images, over black or white, relative to 16 bits
};

/// Returns the unit vector of the nearest code with `bits` bits, half of them per axis. The lowest code per axis is
/// -(2^(bits/2-1) - 1).
/// Range   bits: even, 4 … 32; n: unit.
/// Source  Cigolle et al. 2014.
std::array<double, 3> rounded_normal(const std::array<double, 3>& n, int bits);

/// Returns the results for 16, 12, 10, 8 and 6 bits; none if the scene has no normals. Writes the coarser shards to
/// folders of `out`.
/// Errors  InputError: a shard cannot be read or written.
std::vector<NormalBits> normal_bits(const std::filesystem::path& scene, const std::filesystem::path& out, Codec codec,
                                    int threads);

}  // namespace gigabake::bench
