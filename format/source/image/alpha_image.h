/// Image made of the colours of one image and the alpha of another.
#pragma once

#include <optional>

#include "format/source/mesh.h"

namespace gigabake {

/// Returns a PNG with the colours of `color` (none: white) and the alpha channel of `alpha`. If `alpha` has no alpha
/// channel, its first channel is used. The size is that of `color`; `alpha` is sampled at the nearest texel.
/// Errors  InputError, as decode_image().
EncodedImage with_alpha(const std::optional<EncodedImage>& color, const EncodedImage& alpha);

}  // namespace gigabake
