/// A chunk in storage format: a zlib frame around deflate blocks, then HDF5's Fletcher-32 of that frame.
///
/// A chunk has one compressed block per `block_bytes`. If the compressed size is not smaller, the chunk has stored
/// (uncompressed) blocks instead.
///
/// Exact   Integers: host and device give the same bytes.
/// Source  RFC 1950; HDF5 file format, Fletcher-32.
#pragma once

#include <cstdint>

#include "core/base/host_device.h"
#include "core/codec/matches.h"

namespace gigabake::deflate {

inline constexpr std::uint32_t zlib_header_bytes = 2, checksum_bytes = 4, stored_block_bytes = 65535;
/// Returns a byte of the zlib header: deflate with a window of 32 KiB, level "fastest".
GB_HD std::uint8_t zlib_header_byte(std::uint32_t i) { return i == 0 ? 0x78 : 0x01; }
/// The bytes of a chunk that are not deflate's: the zlib header and both checksums.
inline constexpr std::uint32_t frame_bytes = zlib_header_bytes + 2 * checksum_bytes;

/// Returns the number of compressed blocks; an empty chunk has one.
GB_HD std::uint32_t blocks_of(std::uint32_t bytes) { return bytes == 0 ? 1 : (bytes - 1) / block_bytes + 1; }
GB_HD std::uint32_t stored_blocks_of(std::uint32_t bytes) {
  return bytes == 0 ? 1 : (bytes - 1) / stored_block_bytes + 1;
}

/// Returns the bytes of a chunk in stored blocks. deflate_size() returns this size or that of `bits` compressed bits,
/// if the latter is smaller.
GB_HD std::uint32_t stored_size(std::uint32_t bytes) { return bytes + 5 * stored_blocks_of(bytes); }
GB_HD bool stored_as_is(std::uint32_t bytes, std::uint64_t bits) { return (bits + 7) / 8 >= stored_size(bytes); }
GB_HD std::uint32_t deflate_size(std::uint32_t bytes, std::uint64_t bits) {
  return stored_as_is(bytes, bits) ? stored_size(bytes) : std::uint32_t((bits + 7) / 8);
}

/// Returns byte `at` of a chunk's stored blocks.
GB_HD std::uint8_t stored_byte(const std::uint8_t* bytes, std::uint32_t size, std::uint32_t at) {
  const std::uint32_t block = at / (stored_block_bytes + 5), within = at % (stored_block_bytes + 5);
  if (within >= 5) return bytes[block * stored_block_bytes + within - 5];
  const std::uint32_t left = size - block * stored_block_bytes;
  const std::uint32_t here = left < stored_block_bytes ? left : stored_block_bytes;
  if (within == 0) return block + 1 == stored_blocks_of(size) ? 1 : 0;
  return std::uint8_t((within < 3 ? here : ~here) >> (within % 2 == 1 ? 0 : 8));
}

/// The two sums of Adler-32 and Fletcher-32: the sum of all numbers, and the sum of all prefix sums. The modulus is
/// 65521 for Adler-32 and 65535 for Fletcher-32. Parts of a sequence can be summed separately and joined.
template <std::uint32_t Modulus>
struct DoubleSum {
  std::uint64_t each, running;

  /// Adds a number of the sequence; `behind` numbers follow it.
  /// Range   number < 2^16, behind < 2^31; at most 2^16 numbers between folds.
  GB_HD void add(std::uint32_t number, std::uint32_t behind) {
    each += number;
    running += std::uint64_t(number) * (behind + 1);
  }
  /// Reduces both sums to [1, Modulus]; zero stays zero, because HDF5 distinguishes 65535 from 0.
  GB_HD void fold() {
    each = each == 0 ? 0 : (each - 1) % Modulus + 1;
    running = running == 0 ? 0 : (running - 1) % Modulus + 1;
  }
  GB_HD void join(const DoubleSum& other) {
    each += other.each;
    running += other.running;
    fold();
  }
};

using Adler = DoubleSum<65521>;
using Fletcher = DoubleSum<65535>;

/// Returns Adler-32 from the sums of all `bytes` bytes.
GB_HD std::uint32_t adler32_of(const Adler& sums, std::uint32_t bytes) {
  return std::uint32_t((sums.running + bytes) % 65521) << 16 | std::uint32_t((sums.each + 1) % 65521);
}

/// Returns Fletcher-32 from the folded sums of all words. Words are big-endian; a zero follows an odd last byte.
GB_HD std::uint32_t fletcher32_of(const Fletcher& sums) {
  return std::uint32_t(sums.running) << 16 | std::uint32_t(sums.each);
}
GB_HD std::uint32_t fletcher_words(std::uint32_t bytes) { return bytes / 2 + bytes % 2; }
GB_HD std::uint32_t fletcher_word(const std::uint8_t* bytes, std::uint32_t size, std::uint32_t word) {
  return std::uint32_t(bytes[2 * word]) << 8 | (2 * word + 1 < size ? bytes[2 * word + 1] : 0u);
}

/// Returns a checksum's byte `i`: Adler-32 is stored big-endian, HDF5's Fletcher-32 little-endian.
GB_HD std::uint8_t adler_byte(std::uint32_t adler, std::uint32_t i) { return std::uint8_t(adler >> (8 * (3 - i))); }
GB_HD std::uint8_t fletcher_byte(std::uint32_t sum, std::uint32_t i) { return std::uint8_t(sum >> (8 * i)); }

}  // namespace gigabake::deflate
