/// All chunks of a file's columns, unpacked: what was packed when it was written.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "format/shard/hdf5/chunk_codec.h"

namespace gigabake {

struct FileChunk {
  std::string column;  ///< its name without groups: "rgb" on every level
  ChunkFilters filters;
  std::vector<std::uint8_t> raw;  ///< as it was before any filter
};

/// Errors  InputError: file, column, what is wrong with it.
/// Cost    Everything at once in memory: for measurements, not for readers.
std::vector<FileChunk> file_chunks(const std::filesystem::path& path);

}  // namespace gigabake
