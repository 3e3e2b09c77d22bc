/// Pieces of one content file, for whoever needs its beginning alone.
#pragma once

#include <cstdint>
#include <fstream>
#include <vector>

#include "format/source/source.h"
#include "format/source/source_files.h"

namespace gigabake {

/// Offsets are from where the tile begins: in a composite that is inside the file. What is packed (gzip, archives) is
/// unpacked whole.
class ContentPieces {
 public:
  /// Errors  InputError: as SourceFiles::read_content(), of what is packed.
  ContentPieces(const TileRef& tile, const SourceFiles& files);

  /// Fewer bytes where the tile ends or cannot be read.
  std::vector<std::uint8_t> read(std::uint64_t offset, std::uint64_t bytes);

 private:
  std::ifstream file_;
  std::vector<std::uint8_t> whole_;  ///< of what is packed
  std::uint64_t begin_ = 0, end_ = 0;
};

}  // namespace gigabake
