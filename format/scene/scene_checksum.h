/// The checksum that the text of a scene.xml or of a page carries: XXH3-128 with zeros in place of its own digits.
#pragma once

#include <string>
#include <string_view>
#include <utility>

#include "lattice/hash128.h"

namespace gigabake {

/// Range   The `Checksum` that counts is the first of the text, as the writer makes it.
struct TextChecksum {
  Hash128 value;         ///< of the text; zero where it has no `Checksum`
  bool is_said = false;  ///< and the text says it
};
TextChecksum checksum_of(std::string_view text);

/// A text that says its checksum.
struct SummedText {
  std::string text;
  Hash128 checksum;
};

/// The text with the `Checksum` that belongs to it, in place of the one that it has. Without one it stays as it is.
SummedText summed(std::string text);
inline std::string with_checksum(std::string text) { return summed(std::move(text)).text; }

}  // namespace gigabake
