/// Which codec an image is for.
#pragma once

#include <cstdint>

#include "format/source/mesh.h"

namespace gigabake {

enum class Encoding : std::uint8_t { png, jpeg, webp };

/// By its first bytes. Errors  InputError: none of them.
Encoding encoding_of(const EncodedImage& encoded);

}  // namespace gigabake
