/// Reading of all chunks of a file's columns, unpacked to the bytes that were packed when it was written.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "format/shard/hdf5/chunk_codec.h"

namespace gigabake {

struct FileChunk {
  std::string column;  ///< name without groups: "rgb" on every level
  ChunkFilters filters;
  std::vector<std::uint8_t> raw;  ///< the bytes before any filter
};

/// Returns all chunks of the file.
/// Cost    Holds everything in memory: for measurements, not for readers.
/// Errors  InputError: file, column, fault.
std::vector<FileChunk> file_chunks(const std::filesystem::path& path);

}  // namespace gigabake
