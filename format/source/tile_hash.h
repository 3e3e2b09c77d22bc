/// Identity of a content file: a hash of all files that read_tile() reads, and of the transform.
#pragma once

#include <filesystem>
#include <span>
#include <vector>

#include "core/io/hash128.h"
#include "format/source/source.h"
#include "format/system/file_stamp.h"

namespace gigabake {

struct TileIdentity {
  Hash128 hash;
  std::vector<StampedFile>
      files;  ///< files that were read or are missing, the content file first; each stamp was taken before the file was
              ///< read
};

/// Computes XXH3-128 of the file, of every file that it refers to (buffers, images), of the placement and the up axis.
/// If the file is a composite, only the tile's part is hashed. If it is a raster, the tile's mesh and image are hashed.
/// Also returns the names and stamps of all these files.
/// Errors  InputError like read_tile().
TileIdentity identify_tile(const TileRef& tile, const std::filesystem::path& root);

/// Returns only the hash.
Hash128 tile_hash(const TileRef& tile, const std::filesystem::path& root);

/// Returns the path of an entry of TileIdentity::files. Does not resolve links in the path, because a link may later be
/// redirected to another file.
std::filesystem::path path_of(const TileRef& tile, const StampedFile& file);

/// Returns true if the files of the tile have the same content as when they were stamped, as far as their stamps can
/// tell (format/system/file_stamp.h). Returns false if there are no files or one stamp was not settled. Reads no file.
bool are_unchanged(const TileRef& tile, std::span<const StampedFile> files);

}  // namespace gigabake
