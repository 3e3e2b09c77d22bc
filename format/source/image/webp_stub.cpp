#include "core/base/error.h"
#include "format/source/image/codecs.h"

namespace gigabake {

bool has_webp() { return false; }

ImageSize webp_size(const EncodedImage& image) { throw InputError(image.name, "", *missing_codec("EXT_texture_webp")); }
bool is_lossy_webp(const EncodedImage& image) { throw InputError(image.name, "", *missing_codec("EXT_texture_webp")); }
Image decode_webp(const EncodedImage& image) { throw InputError(image.name, "", *missing_codec("EXT_texture_webp")); }

}  // namespace gigabake
