/// Which material of a source makes nothing visible, for messages.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "format/source/source.h"

namespace gigabake {

/// Returns the first material of a glTF or OBJ tile that is invisible everywhere (alpha 0): its name in quotes, or its
/// number in the file if it has none. Cost  reads the document again. Errors  InputError as read_tile().
std::optional<std::string> invisible_material(const TileRef& tile, const std::filesystem::path& root);

}  // namespace gigabake
