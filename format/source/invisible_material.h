/// Search for an invisible material, which messages name.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "format/source/source.h"

namespace gigabake {

/// The alpha below which a material is invisible, because a voxel stores alpha in 8 bits.
inline constexpr float min_visible_alpha = 0.5f / 255;

/// Returns the first material of a glTF or OBJ tile that is invisible everywhere (alpha 0). The result is its name in
/// quotes, or its number in the file if it has no name.
/// Cost    Reads the document again.
/// Errors  InputError like read_tile().
std::optional<std::string> invisible_material(const TileRef& tile, const std::filesystem::path& root);

}  // namespace gigabake
