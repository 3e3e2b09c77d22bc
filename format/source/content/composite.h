/// 3D Tiles 1.0 "Composite": several tiles in one file.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "format/source/content/content_magic.h"

namespace gigabake {

/// Bytes [begin, end) of a file; end 0: the whole file.
struct ByteRange {
  std::uint64_t begin = 0, end = 0;
  friend bool operator==(const ByteRange&, const ByteRange&) = default;
};

struct CompositePart {
  ByteRange range;
  ContentMagic magic = ContentMagic::unknown;
  std::string name;  ///< "[1]", or "[1][0]" in a composite inside
};

/// Returns the innermost tiles in their order.
/// Errors  InputError: a length beyond the file, composites that nest deeper than eight.
std::vector<CompositePart> parts_of_composite(const std::filesystem::path& file, std::span<const std::uint8_t> bytes);

}  // namespace gigabake
