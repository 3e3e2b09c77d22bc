/// Identity of a content file: a hash of all files that read_tile() reads, and of the transform.
#pragma once

#include <filesystem>
#include <vector>

#include "core/io/hash128.h"
#include "format/source/source.h"
#include "format/system/file_stamp.h"

namespace gigabake {

struct TileIdentity {
  Hash128 hash;
  std::vector<StampedFile>
      files;  ///< that were read or missed, the content file first; stamps are older than the reading
};

/// Computes XXH3-128 of the file, of every file that it refers to (buffers, images), of the placement and the up axis.
/// If the file is a composite, only the tile's part is hashed. Also returns the names and stamps of these files.
/// Errors  InputError as read_tile().
TileIdentity identify_tile(const TileRef& tile, const std::filesystem::path& root);

/// Returns only the hash.
Hash128 tile_hash(const TileRef& tile, const std::filesystem::path& root);

/// Returns the present path of an entry of TileIdentity::files. Follows links at each call: a link may have been
/// redirected to another file.
std::filesystem::path path_of(const TileRef& tile, const StampedFile& file);

}  // namespace gigabake
