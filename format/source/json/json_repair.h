/// Repair of JSON text whose strings have invalid bytes or escapes, such as names that exporters write in Latin-1.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>

namespace gigabake {

/// Returns the text with U+FFFD in place of each invalid byte of UTF-8 and each unpaired surrogate escape ("\ud800").
/// Returns nullopt if there is nothing to replace. Without the repair, the JSON library would refuse the whole text
/// because of one damaged name.
std::optional<std::string> repaired_json(std::span<const std::uint8_t> text);

}  // namespace gigabake
