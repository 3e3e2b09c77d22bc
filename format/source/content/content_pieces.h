/// Reader of parts of one content file, for callers that need only its beginning.
#pragma once

#include <cstdint>
#include <fstream>
#include <vector>

#include "format/source/source.h"
#include "format/source/source_files.h"

namespace gigabake {

/// Reader of parts. Offsets are relative to the tile, which may begin inside a composite. Packed files (gzip, archives)
/// are unpacked completely.
class ContentPieces {
 public:
  /// Errors  InputError, as SourceFiles::read_content(): a packed file cannot be read.
  ContentPieces(const TileRef& tile, const SourceFiles& files);

  /// Returns fewer bytes if the tile ends or cannot be read.
  std::vector<std::uint8_t> read(std::uint64_t offset, std::uint64_t bytes);

 private:
  std::ifstream file_;
  std::vector<std::uint8_t> whole_;  ///< of a packed file
  std::uint64_t begin_ = 0, end_ = 0;
};

}  // namespace gigabake
