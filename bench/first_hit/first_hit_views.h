/// The views of the first-hit benchmark: fixed views of any scene, derived from the box of its voxels.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "kernels/first_hit/first_hit_camera.h"
#include "kernels/first_hit/first_hit_tree.h"

namespace gigabake::bench {

/// A camera, or random rays.
struct FirstHitBenchView {
  std::string name;
  std::optional<kernels::FirstHitCamera> camera;  ///< nullopt: uniformly random rays between points of the box
};

/// Returns the fixed views and one of random rays.
///
/// Views of the whole scene: from the south-east, parallel and in perspective, and both again, close enough to fill the
/// image. Other views: grazing from a corner; vertical; from ten voxels above the ground in the middle; from below the
/// ground; random rays.
std::vector<FirstHitBenchView> first_hit_views(const kernels::FirstHitTree& tree, int width, int height);

std::vector<kernels::FirstHitRay> random_rays(const kernels::FirstHitTree& tree, std::size_t count, unsigned seed);

}  // namespace gigabake::bench
