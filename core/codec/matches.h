/// The search for matches in a chunk, and the parsing of a segment into literals and matches.
///
/// Matches depend only on the bytes. The candidate of position p is the latest earlier position, at most 32,767 back,
/// whose next four bytes have the same hash bucket (of 16,384). One serial pass with a table finds the candidates.
/// Parallel passes find the same candidates if each begins 32 KiB before its first position. Segments are parsed
/// independently: a match ends within its segment but may refer to bytes before the segment.
///
/// Exact   Integers: host and device return the same tokens.
/// Range   All arrays of bytes must be readable `readable_beyond` bytes beyond their end.
/// Source  docs/experiments/kernels.md describes the alternatives that were measured.
#pragma once

#include <bit>
#include <cstdint>
#include <cstring>

#include "core/base/host_device.h"
#include "core/codec/deflate_symbols.h"

namespace gigabake::deflate {

/// The sizes of blocks and segments. Each block has separate codes; each segment is parsed separately. A block consists
/// of whole segments; the last block and segment of a chunk may be shorter.
inline constexpr std::uint32_t block_bytes = 1 << 15, segment_bytes = 1 << 10;
inline constexpr std::uint32_t segments_per_block = block_bytes / segment_bytes;
inline constexpr std::uint32_t readable_beyond = 16;
inline constexpr std::uint32_t min_match = 4, max_distance = 32767;
/// The match length from which the parser does not search for a better match at the next byte.
inline constexpr std::uint32_t long_enough = 16;

GB_HD std::uint32_t four_bytes(const std::uint8_t* at) {
#if defined(__CUDA_ARCH__)
  const auto address = reinterpret_cast<std::uintptr_t>(at);
  const auto* words = reinterpret_cast<const std::uint32_t*>(address & ~std::uintptr_t(3));
  return __funnelshift_r(words[0], words[1], unsigned(address & 3) * 8);
#else
  std::uint32_t value;
  std::memcpy(&value, at, 4);
  return value;
#endif
}

/// A bucket of the hash table: the latest position whose four bytes have the bucket's hash, modulo 65536.
using Bucket = std::uint16_t;
inline constexpr std::uint32_t bucket_bits = 14, buckets = 1 << bucket_bits;
GB_HD std::uint32_t bucket_of(std::uint32_t bytes) { return bytes * 0x9E3779B1u >> (32 - bucket_bits); }
GB_HD Bucket bucket_with(std::uint32_t position) { return Bucket(position); }
GB_HD std::uint32_t distance_to(Bucket bucket, std::uint32_t position) { return (position - bucket) & 0xffff; }
GB_HD bool in_reach(std::uint32_t distance) { return distance - 1 < max_distance; }

/// Returns the content of an empty bucket for a block that begins at `position`. Its distance from all positions of
/// that block exceeds max_distance. aged() must update the table at the start of each block, before positions wrap at
/// 65,536.
GB_HD Bucket empty_bucket(std::uint32_t position) { return Bucket(position - block_bytes); }
/// Compares 16-bit numbers, so that the host ages a vector of buckets at once: distances in reach are positive.
GB_HD Bucket aged(Bucket bucket, std::uint32_t position) {
  static_assert(max_distance == 0x7fff);
  return std::int16_t(position - bucket) > 0 ? bucket : empty_bucket(position);
}

/// A match; length 0 means no match.
struct Match {
  std::uint32_t length = 0, distance = 0;
};

/// Returns the number of equal bytes before the first difference, at most eight.
GB_HD std::uint32_t equal_of_eight(const std::uint8_t* a, const std::uint8_t* b) {
#if defined(__CUDA_ARCH__)
  const std::uint32_t low = four_bytes(a) ^ four_bytes(b);
  if (low != 0) return unsigned(__ffs(int(low)) - 1) / 8;
  const std::uint32_t high = four_bytes(a + 4) ^ four_bytes(b + 4);
  return high == 0 ? 8 : 4 + unsigned(__ffs(int(high)) - 1) / 8;
#else
  std::uint64_t left, right;
  std::memcpy(&left, a, 8);
  std::memcpy(&right, b, 8);
  return unsigned(std::countr_zero(left ^ right)) / 8;
#endif
}

/// Returns the number of equal bytes before the first difference, at most `maximum`.
GB_HD std::uint32_t equal_bytes(const std::uint8_t* a, const std::uint8_t* b, std::uint32_t maximum) {
  for (std::uint32_t n = 0; n < maximum; n += 8)
    if (const std::uint32_t equal = equal_of_eight(a + n, b + n); equal < 8)
      return n + equal < maximum ? n + equal : maximum;
  return maximum;
}

/// Returns the match of `position` with the candidate `found`, if the match is longer than `length`; else no match. The
/// match does not extend beyond `end`. A match longer than `length` includes byte `length`, counted from 0. The four
/// bytes up to that byte are compared first, because they differ for most candidates.
/// Range   length ≥ min_match - 1.
GB_HD Match match_in(Bucket found, const std::uint8_t* bytes, std::uint32_t position, std::uint32_t end,
                     std::uint32_t length) {
  const std::uint32_t distance = distance_to(found, position);
  const std::uint32_t maximum = end - position < max_match ? end - position : max_match;
  if (!in_reach(distance) || length >= maximum) return {};
  const std::uint8_t *const here = bytes + position, *const tried = here + length + 1 - min_match;
  if (four_bytes(tried) != four_bytes(tried - distance)) return {};
  const std::uint32_t equal = equal_bytes(here, here - distance, maximum);
  return equal > length ? Match{equal, distance} : Match{};
}
GB_HD Match match_of(Token token) { return {token >> 16, token & 0xffff}; }

/// Returns the end of the positions that enter the table, at most `end`. At least four bytes of the chunk begin at each
/// of these positions.
GB_HD std::uint32_t entered_before(std::uint32_t chunk_bytes, std::uint32_t end) {
  const std::uint32_t all = chunk_bytes < min_match ? 0 : chunk_bytes - (min_match - 1);
  return all < end ? all : end;
}

/// Returns the end of the segment that contains `position`, in a block that ends at `block_end`.
GB_HD std::uint32_t segment_end(std::uint32_t position, std::uint32_t block_end) {
  const std::uint32_t end = (position / segment_bytes + 1) * segment_bytes;
  return end < block_end ? end : block_end;
}

/// Returns true if a literal followed by the match `next` is better than the match `here`. `next` must be at least as
/// long as `here`. One byte of length counts as much as two bits of distance.
GB_HD bool better_one_later(const Match& here, const Match& next) {
  if (next.length < here.length) return false;
  const int bytes = int(next.length) - int(here.length);
  return 2 * bytes + int(floor_log2(here.distance)) - int(floor_log2(next.distance)) > 2;
}

/// Passes the tokens of bytes [begin, end) to `add(token)` in order. Matches have at least `min_match_bytes` bytes.
/// `match_at(p, end, length)` returns match_in() at position p. It may also return a match that has `min_match_bytes`
/// or more and is not longer than `length`. parse_segment() calls it for ascending positions and may skip positions.
/// Range   min_match_bytes ≥ min_match.
template <class MatchAt, class Add>
GB_HD void parse_segment(const std::uint8_t* bytes, std::uint32_t begin, std::uint32_t end,
                         std::uint32_t min_match_bytes, MatchAt& match_at, Add& add) {
  Match here = match_at(begin, end, min_match_bytes - 1);
  for (std::uint32_t at = begin;;) {
    if (here.length == 0) {
      add(bytes[at++]);
    } else {
      if (here.length < long_enough && at + 1 < end) {
        const Match next = match_at(at + 1, end, here.length - 1);
        if (better_one_later(here, next)) {
          add(bytes[at++]);
          here = next;
          continue;
        }
      }
      add(match_token(here.length, here.distance));
      at += here.length;
    }
    if (at == end) return;
    here = match_at(at, end, min_match_bytes - 1);
  }
}

}  // namespace gigabake::deflate
