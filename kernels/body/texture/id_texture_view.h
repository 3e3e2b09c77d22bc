/// A part's texture of ids, from which voxels take classes.
#pragma once

#include <cstdint>

#include "core/base/rules.h"
#include "core/octree/texel_ids.h"

namespace gigabake::kernels {

/// A texture of ids and its sampler. The nearest texel counts, whatever the sampler's filter is.
struct IdTextureView {
  std::int32_t texture = -1;  ///< index into CellInput::textures, -1: none; only its level 0 is read
  Wrap wrap_s = Wrap::repeat, wrap_t = Wrap::repeat;
  TexelIds texels = {};
};

}  // namespace gigabake::kernels
