/// What normals of fewer bits would save and cost: the shards of a bake written again with coarser ones.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <vector>

#include "lattice/rules.h"

namespace gigabake::bench {

struct NormalBits {
  int bits = 16;                           ///< of both octahedral axes together
  double sphere_deg = 0, largest_deg = 0;  ///< of directions all over the sphere: mean and largest angle
  double mean_deg = 0, most_deg = 0;  ///< of the scene's normals of lod 0, from their 16 bits: mean, and 99 % are below
  std::uint64_t bytes = 0;            ///< of all shards
  double lit_flip = 0;                ///< mean of lit pictures, before black or white, from those of 16 bits
};

/// `bits`, half of them an axis: the nearest code on each, from -(2^(bits/2-1) - 1) up. As a unit vector.
/// Source  Cigolle et al. 2014. Range  bits: even, 4 … 32; n: unit.
std::array<double, 3> rounded_normal(const std::array<double, 3>& n, int bits);

/// With 16, 12, 10, 8 and 6 bits; none where the scene has no normals. The coarser shards stand in folders of `out`.
/// Errors  InputError: a shard that cannot be read or written.
std::vector<NormalBits> normal_bits(const std::filesystem::path& scene, const std::filesystem::path& out, Codec codec,
                                    int threads);

}  // namespace gigabake::bench
