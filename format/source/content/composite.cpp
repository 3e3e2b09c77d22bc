#include "format/source/content/composite.h"

#include "core/io/byte_cursor.h"

namespace gigabake {
namespace {

constexpr int deepest_composite = 8;

/// Adds the tiles of a composite and of its nested composites to `out`.
/// Source  3D Tiles 1.0, "Composite".
void add_parts(ByteCursor in, int depth, const std::string& name, std::vector<CompositePart>& out) {
  if (depth == deepest_composite) in.fail("composites nest deeper than 8");
  in.word("the composite's header");
  if (const std::uint32_t version = in.word("the composite's header"); version != 1)
    in.fail("expected a composite of version 1, got " + std::to_string(version));
  in.word("the composite's header");
  const std::uint32_t tiles = in.word("the composite's header");
  for (std::uint32_t i = 0; i < tiles; ++i) {
    ByteCursor head = in;
    const std::uint64_t begin = head.at();
    const ContentMagic magic = content_magic(head.take(4, "a tile of the composite"));
    head.word("a tile of the composite");
    const std::uint32_t length = head.word("a tile of the composite");
    if (length < 12) head.fail("a tile of the composite states a length of " + std::to_string(length) + " bytes");
    const std::string part = name + "[" + std::to_string(i) + "]";
    const std::span<const std::uint8_t> bytes = in.take(length, "a tile of the composite");
    if (magic == ContentMagic::composite)
      add_parts({in.file, in.whole, bytes}, depth + 1, part, out);
    else
      out.push_back({{begin, begin + length}, magic, part});
  }
}

}  // namespace

std::vector<CompositePart> parts_of_composite(const std::filesystem::path& file, std::span<const std::uint8_t> bytes) {
  std::vector<CompositePart> parts;
  add_parts({file, bytes, bytes}, 0, "", parts);
  return parts;
}

}  // namespace gigabake
