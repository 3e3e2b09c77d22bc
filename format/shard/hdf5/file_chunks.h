/// A reader of all chunks of a file's columns. Each chunk is unpacked to the bytes that the writer packed.
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
/// Cost    Holds all chunks in memory. The function is meant for measurements, not for reading shards.
/// Errors  InputError naming file, column and fault.
std::vector<FileChunk> file_chunks(const std::filesystem::path& path);

}  // namespace gigabake
