/// JSON text whose strings have bytes or escapes that are no characters, as exporters write names in Latin-1.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>

namespace gigabake {

/// Returns the text with U+FFFD in place of each invalid byte of UTF-8 and of each surrogate escape without its other
/// half ("\ud800"); none if there is nothing to replace. A library would refuse the whole text, though only a name
/// is damaged.
std::optional<std::string> repaired_json(std::span<const std::uint8_t> text);

}  // namespace gigabake
