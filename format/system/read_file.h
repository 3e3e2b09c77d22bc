/// Reading of a whole file into memory.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

namespace gigabake {

/// Returns the content of the file.
/// Errors  InputError: no such file, not a regular file, larger than `max_bytes`, or cannot be read.
std::vector<std::uint8_t> read_whole_file(const std::filesystem::path& path, std::uint64_t max_bytes = std::uint64_t(1)
                                                                                                       << 32);

}  // namespace gigabake
