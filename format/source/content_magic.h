/// What a content file is, by its first bytes; names and media types are not to be trusted.
#pragma once

#include <cstdint>
#include <span>

namespace gigabake {

enum class ContentMagic : std::uint8_t { glb, b3dm, i3dm, points, composite, json, zip, unknown };

/// head: the first bytes of the file; four are enough.
ContentMagic content_magic(std::span<const std::uint8_t> head);

}  // namespace gigabake
