#include "format/source/content/content_magic.h"

#include <algorithm>
#include <string_view>

namespace gigabake {

ContentMagic content_magic(std::span<const std::uint8_t> head) {
  const std::string_view magic(reinterpret_cast<const char*>(head.data()), std::min<std::size_t>(head.size(), 4));
  if (magic == "glTF") return ContentMagic::glb;
  if (magic == "b3dm") return ContentMagic::b3dm;
  if (magic == "i3dm") return ContentMagic::i3dm;
  if (magic == "pnts") return ContentMagic::points;
  if (magic == "cmpt") return ContentMagic::composite;
  if (magic == "PK\x03\x04") return ContentMagic::zip;
  const auto first = magic.find_first_not_of(" \t\r\n");
  return first != std::string_view::npos && magic[first] == '{' ? ContentMagic::json : ContentMagic::unknown;
}

}  // namespace gigabake
