/// The identity of a content file: everything that read_tile() reads, and where it stands.
#pragma once

#include <filesystem>

#include "format/shard.h"
#include "format/source.h"

namespace gigabake {

/// XXH3-128 of the file, of every file it names (buffers, images), of the placement and the up axis.
/// Errors  InputError as read_tile().
Hash128 tile_hash(const TileRef& tile, const std::filesystem::path& root);

}  // namespace gigabake
