/// The head of a tileset document: version, extensions and axes.
#pragma once

#include <filesystem>

#include "core/math/frames.h"
#include "format/source/tiles/tileset_document.h"
#include "format/system/json/json_members.h"

namespace gigabake {

/// Returns the up axis of the glTF content, which `asset` states; y by default.
/// Errors  InputError: the axis is unknown.
UpAxis tileset_up_axis(const JsonMembers& asset);

/// Checks that the document can be used.
/// Errors  InputError: the version or a required extension is unknown, or the root is missing or malformed.
void check_tileset_head(const std::filesystem::path& file, const TilesetDocument& document);

}  // namespace gigabake
