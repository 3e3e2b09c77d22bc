/// Content that is kept as servers send it: packed by gzip.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

namespace gigabake {

/// No content of 3D Tiles begins as a gzip file does.
bool is_gzip(std::span<const std::uint8_t> head);

/// What a whole gzip file holds. Cost  memory follows what is unpacked.
/// Errors  InputError: damaged, cut, followed by other bytes, or more than `most_bytes`.
std::vector<std::uint8_t> unpacked_gzip(const std::filesystem::path& file, std::span<const std::uint8_t> packed,
                                        std::uint64_t most_bytes);

/// Its first bytes, at most `most_bytes`, from the first bytes of the file. Where these are damaged, fewer.
std::vector<std::uint8_t> unpacked_gzip_head(std::span<const std::uint8_t> packed_head, std::size_t most_bytes);

}  // namespace gigabake
