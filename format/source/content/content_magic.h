/// The format of a content file, recognized by its first bytes, because names and media types are not reliable.
#pragma once

#include <cstdint>
#include <span>

namespace gigabake {

enum class ContentMagic : std::uint8_t { glb, b3dm, i3dm, points, composite, json, zip, unknown };

/// Returns the format. `head` has at least the first four bytes of the file.
ContentMagic content_magic(std::span<const std::uint8_t> head);

}  // namespace gigabake
