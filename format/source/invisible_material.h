/// Search for a material that is invisible, for messages.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "format/source/source.h"

namespace gigabake {

/// Alpha below which a material is invisible: a voxel stores eight bits.
inline constexpr float min_visible_alpha = 0.5f / 255;

/// Returns the first material of a glTF or OBJ tile that is invisible everywhere (alpha 0). The result is its name in
/// quotes, or its number in the file if it has no name.
/// Cost    Reads the document again.
/// Errors  InputError as read_tile().
std::optional<std::string> invisible_material(const TileRef& tile, const std::filesystem::path& root);

}  // namespace gigabake
