/// PNG encoder, optimized for speed instead of size, because the image is soon decoded again.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace gigabake {

/// Returns a PNG. `texels` has 3 or 4 bytes per texel, row by row.
/// Errors  InputError under `name`: libpng fails.
std::vector<std::uint8_t> png_bytes(const std::string& name, int width, int height,
                                    std::span<const std::uint8_t> texels);

}  // namespace gigabake
