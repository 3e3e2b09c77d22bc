/// 3D Tiles 1.0 "Composite": several tiles in one file.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "format/source/content/content_magic.h"
#include "format/source/source.h"

namespace gigabake {

struct CompositePart {
  ByteRange range;
  ContentMagic magic = ContentMagic::unknown;
  std::string name;  ///< "[1]", or "[1][0]" in a nested composite
};

/// Returns the tiles of a composite and of its nested composites, in the order of the file.
/// Errors  InputError: a length exceeds the file, or composites nest deeper than eight levels.
std::vector<CompositePart> parts_of_composite(const std::filesystem::path& file, std::span<const std::uint8_t> bytes);

}  // namespace gigabake
