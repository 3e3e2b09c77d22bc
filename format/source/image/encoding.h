/// Codecs of images.
#pragma once

#include <cstdint>

#include "format/source/mesh.h"

namespace gigabake {

enum class Encoding : std::uint8_t { png, jpeg, webp };

/// Returns the codec, recognized by the first bytes.
/// Errors  InputError: the bytes belong to no supported codec.
Encoding encoding_of(const EncodedImage& encoded);

}  // namespace gigabake
