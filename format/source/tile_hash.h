/// The identity of a content file: everything that read_tile() reads, and where it stands.
#pragma once

#include <filesystem>
#include <vector>

#include "format/source/source.h"
#include "format/system/file_stamp.h"
#include "lattice/hash128.h"

namespace gigabake {

struct TileIdentity {
  Hash128 hash;
  std::vector<StampedFile>
      files;  ///< that were read or missed, the content file first; stamps are older than the reading
};

/// XXH3-128 of the file (of a composite, of the tile's part), of every file it names (buffers, images), of the
/// placement and the up axis; and which files these were. Errors  InputError as read_tile().
TileIdentity identify_tile(const TileRef& tile, const std::filesystem::path& root);

/// The hash alone.
Hash128 tile_hash(const TileRef& tile, const std::filesystem::path& root);

/// Where one of TileIdentity::files is now. Links are followed anew at each use: one that leads elsewhere today is
/// another file.
std::filesystem::path path_of(const TileRef& tile, const StampedFile& file);

}  // namespace gigabake
