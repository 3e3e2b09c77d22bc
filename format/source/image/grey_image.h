/// Tells grey images, for example height maps, from coloured images.
#pragma once

#include "format/source/mesh.h"

namespace gigabake {

/// Returns whether the image is grey: no texel's channels differ by more than JPEG's errors do.
/// Cost    Decodes rows up to the first coloured texel, or the whole image if its format has no complete rows.
/// Errors  InputError like decode_image().
bool is_grey(const EncodedImage& image);

}  // namespace gigabake
