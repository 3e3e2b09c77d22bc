/// Reader of parts of one content file, for callers that need only its beginning.
#pragma once

#include <cstdint>
#include <fstream>
#include <vector>

#include "format/source/source.h"
#include "format/source/source_files.h"

namespace gigabake {

/// A reader of parts of one tile. Offsets are relative to the beginning of the tile, which may be inside a composite. A
/// compressed file (gzip, archive) is unpacked completely.
class ContentPieces {
 public:
  /// Errors  InputError like SourceFiles::read_content(): a compressed file cannot be read.
  ContentPieces(const TileRef& tile, const SourceFiles& files);

  /// Returns `bytes` bytes from `offset` on; fewer if the tile ends or cannot be read.
  std::vector<std::uint8_t> read(std::uint64_t offset, std::uint64_t bytes);

 private:
  std::ifstream file_;
  std::vector<std::uint8_t> whole_;  ///< the unpacked bytes of a compressed file
  std::uint64_t begin_ = 0, end_ = 0;
};

}  // namespace gigabake
