/// Image with the colours of one image and the alpha of another image.
#pragma once

#include <optional>

#include "format/source/mesh.h"

namespace gigabake {

/// Returns a PNG with the colours of `color` (white if nullopt) and the alpha channel of `alpha`. If `alpha` has no
/// alpha channel, its first channel is used. The size is that of `color`, else of `alpha`. `alpha` is sampled at the
/// nearest texel.
/// Errors  InputError like decode_image().
EncodedImage with_alpha(const std::optional<EncodedImage>& color, const EncodedImage& alpha);

}  // namespace gigabake
