/// Reading of a whole file into memory.
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

}  // namespace gigabake
