/// Texels as an encoded image, packed fast rather than small: it is unpacked again soon.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace gigabake {

/// texels: 3 or 4 bytes each, row by row. Errors  InputError under `name`: libpng cannot.
std::vector<std::uint8_t> png_bytes(const std::string& name, int width, int height,
                                    std::span<const std::uint8_t> texels);

}  // namespace gigabake
