/// Two images in one.
#pragma once

#include <optional>

#include "format/source/mesh.h"

namespace gigabake {

/// A PNG with the colours of `color` (none: white) and the alpha of `alpha`: its alpha channel, or where it has none,
/// its first one. As large as `color`; `alpha` is sampled at the nearest texel. Errors  InputError as decode_image().
EncodedImage with_alpha(const std::optional<EncodedImage>& color, const EncodedImage& alpha);

}  // namespace gigabake
