/// Parallel views of blocks: rays, what they truly meet, and what they would meet of each candidate.
#pragma once

#include <string>
#include <vector>

#include "bench/levels/blocks.h"

namespace gigabake::bench {

struct SightRay {
  Vector3 origin, direction;  ///< direction: unit
};

/// Whether the ray meets a finest voxel.
bool meets_voxel(const Blocks& blocks, const SightRay& ray, double length);

/// What a candidate shows of a ray: alpha.
using Candidate = double (*)(const Blocks& blocks, const SightRay& ray, double length);

struct NamedCandidate {
  std::string name;
  int bytes;  ///< a coarse voxel stores besides colour and normal, before compression
  Candidate alpha;
};

/// All that are compared, in the order of the table.
const std::vector<NamedCandidate>& level_candidates();

}  // namespace gigabake::bench
