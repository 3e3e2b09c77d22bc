/// Reading of a whole file, or of its new end, into memory.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

namespace gigabake {

/// Returns the content of the file.
/// Errors  InputError if the file does not exist, is not a regular file, cannot be read, or is larger than `max_bytes`
///         or memory_limit().
std::vector<std::uint8_t> read_whole_file(const std::filesystem::path& path, std::uint64_t max_bytes = std::uint64_t(1)
                                                                                                       << 32);

struct FileTail {
  std::uint64_t inode = 0;  ///< 0: there is no file
  std::uint64_t size = 0;   ///< of the whole file
  std::vector<std::uint8_t> bytes;
};

/// Returns the bytes from byte `from` to the current end of a file that may grow; none if it is not longer. Opens the
/// file, so that on NFS the size is that of the server.
/// Errors  InputError: the file exists but cannot be opened or read.
FileTail read_tail(const std::filesystem::path& path, std::uint64_t from);

}  // namespace gigabake
