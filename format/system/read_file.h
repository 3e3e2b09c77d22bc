/// A whole file in memory.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

namespace gigabake {

/// Errors  InputError: no such file, not a regular file, larger than `most_bytes`, cannot be read.
std::vector<std::uint8_t> read_whole_file(const std::filesystem::path& path, std::uint64_t most_bytes = std::uint64_t(1)
                                                                                                        << 32);

}  // namespace gigabake
