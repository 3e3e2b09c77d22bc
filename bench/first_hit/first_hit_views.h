/// Where the first-hit benchmark looks from: fixed views of any scene, by the box that holds its voxels.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "kernels/cast/first_hit_camera.h"
#include "kernels/cast/first_hit_tree.h"

namespace gigabake::bench {

/// A picture, or rays without one.
struct FirstHitBenchView {
  std::string name;
  std::optional<kernels::FirstHitCamera> camera;  ///< none: from anywhere in the box to anywhere, uniformly
};

/// Whole scene from the south-east, in parallel and in perspective; the same, close enough to fill the picture; grazing
/// from a corner; straight down; from ten voxels above the ground in the middle; from below it; random rays.
std::vector<FirstHitBenchView> first_hit_views(const kernels::FirstHitTree& tree, int width, int height);

std::vector<kernels::FirstHitRay> random_rays(const kernels::FirstHitTree& tree, std::size_t count, unsigned seed);

}  // namespace gigabake::bench
