/// The checksum in the text of a scene.xml or of a page: XXH3-128 of the text with zeros in place of the checksum's
/// digits.
#pragma once

#include <string>
#include <string_view>
#include <utility>

#include "core/io/hash128.h"

namespace gigabake {

/// The computed checksum of a text, and its comparison with the stored checksum.
/// Range   The first `Checksum` in the text counts; it belongs to the root element.
struct TextChecksum {
  Hash128 value;         ///< hash of the text; zero if it has no `Checksum`
  bool is_said = false;  ///< the text states the same value
};
TextChecksum checksum_of(std::string_view text);

/// A text that contains its checksum.
struct SummedText {
  std::string text;
  Hash128 checksum;
};

/// Returns the text with the correct `Checksum` in place of the existing value. Returns a text without `Checksum`
/// unchanged.
SummedText summed(std::string text);
inline std::string with_checksum(std::string text) { return summed(std::move(text)).text; }

}  // namespace gigabake
