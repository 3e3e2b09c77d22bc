/// The views of the first-hit benchmark: fixed views of any scene, derived from the box of its voxels.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "query/first_hit/first_hit_camera.h"
#include "query/first_hit/first_hit_tree.h"

namespace gigabake::bench {

/// A camera, or random rays.
struct FirstHitBenchView {
  std::string name;
  std::optional<kernels::FirstHitCamera> camera;  ///< nullopt: uniformly random rays between points of the box
};

/// Returns the fixed views and one view of random rays.
///
/// Four views look from the south-east, with parallel rays and in perspective. Two of them show the whole scene, and
/// two are close enough to fill the image. The other views look from a corner at a grazing angle, straight down, from
/// ten voxels above the ground in the middle, and from below the ground.
std::vector<FirstHitBenchView> first_hit_views(const kernels::FirstHitTree& tree, int width, int height);

std::vector<kernels::FirstHitRay> random_rays(const kernels::FirstHitTree& tree, std::size_t count, unsigned seed);

}  // namespace gigabake::bench
