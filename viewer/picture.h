/// A picture of a scene: rays, the pages they ask for, and what they saw.
#pragma once

#include <cstdint>
#include <vector>

#include "kernels/cast.h"
#include "kernels/policy.h"
#include "viewer/page_cache.h"
#include "viewer/sky.h"

namespace gigabake {

/// sRGB, straight alpha; row 0 is the upper one.
struct Picture {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgba;
};

/// Exact   The same bytes for any number of threads and any memory budget of `pages`.
/// Space   4 bytes a pixel, and `pages`.
/// Errors  InputError: a shard that cannot be read.
Picture render(PageCache& pages, const kernels::CastCamera& camera, const Background& background,
               const kernels::CpuPolicy& policy);

}  // namespace gigabake
