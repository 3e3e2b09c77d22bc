/// Unpacking of content that is gzip-compressed, as servers send it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

namespace gigabake {

/// Returns whether the bytes begin like gzip. No content format of 3D Tiles begins like this.
bool is_gzip(std::span<const std::uint8_t> head);

/// Returns the unpacked bytes of a whole gzip file.
/// Cost    Memory grows with the number of unpacked bytes.
/// Errors  InputError: the file is damaged, truncated, followed by other bytes, or unpacks to more than `max_bytes`.
std::vector<std::uint8_t> unpacked_gzip(const std::filesystem::path& file, std::span<const std::uint8_t> packed,
                                        std::uint64_t max_bytes);

/// Unpacks the first bytes of a gzip file. Returns at most `max_bytes` bytes; fewer if `packed_head` is too short or
/// damaged.
std::vector<std::uint8_t> unpacked_gzip_head(std::span<const std::uint8_t> packed_head, std::size_t max_bytes);

}  // namespace gigabake
