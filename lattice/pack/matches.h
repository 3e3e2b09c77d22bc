/// Which earlier bytes a position of a chunk may repeat, and how a segment is parsed into literals and matches.
///
/// What repeats is a function of the bytes alone: the candidate of position p is the latest position before p, at most
/// 32,767 back, whose next four bytes fall into the same of 16,384 buckets. So it is found by one pass with a table, or
/// by many at once where each begins 32 KiB earlier. A segment's parse needs nothing of other segments': its matches
/// end where it does, and reach back beyond where it begins.
///
/// Exact   Integers: host and device give the same tokens.
/// Range   All bytes may be read `readable_beyond` further than they reach.
/// Source  What else was tried: docs/experiments/kernels.md.
#pragma once

#include <bit>
#include <cstdint>
#include <cstring>

#include "lattice/host_device.h"
#include "lattice/pack/deflate_symbols.h"

namespace gigabake::deflate {

/// A block has its own codes, a segment of it its own parse. Blocks are whole segments; a chunk's last ones are
/// shorter.
inline constexpr std::uint32_t block_bytes = 1 << 15, segment_bytes = 1 << 10;
inline constexpr std::uint32_t segments_per_block = block_bytes / segment_bytes;
inline constexpr std::uint32_t readable_beyond = 16;
inline constexpr std::uint32_t shortest_match = 4, longest_distance = 32767;
/// Beyond this no better match is looked for one byte further on.
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

/// The latest position of a bucket, modulo 65536.
using Bucket = std::uint16_t;
inline constexpr std::uint32_t bucket_bits = 14, buckets = 1 << bucket_bits;
GB_HD std::uint32_t bucket_of(std::uint32_t bytes) { return bytes * 0x9E3779B1u >> (32 - bucket_bits); }
GB_HD Bucket bucket_with(std::uint32_t position) { return Bucket(position); }
GB_HD std::uint32_t distance_to(Bucket bucket, std::uint32_t position) { return (position - bucket) & 0xffff; }
GB_HD bool in_reach(std::uint32_t distance) { return distance - 1 < longest_distance; }

/// What an empty bucket holds, and one whose position is out of reach, from the block that begins at `position` on: out
/// of reach for all of its positions. A table is gone over at the start of each block, before 65,536 come round.
GB_HD Bucket empty_bucket(std::uint32_t position) { return Bucket(position - block_bytes); }
GB_HD Bucket aged(Bucket bucket, std::uint32_t position) {
  return in_reach(distance_to(bucket, position)) ? bucket : empty_bucket(position);
}

/// length 0: there is none.
struct Match {
  std::uint32_t length = 0, distance = 0;
};

/// How many of the eight bytes at both places are the same before one differs.
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

/// How many bytes are the same, at most `most`.
GB_HD std::uint32_t equal_bytes(const std::uint8_t* a, const std::uint8_t* b, std::uint32_t most) {
  for (std::uint32_t n = 0; n < most; n += 8)
    if (const std::uint32_t equal = equal_of_eight(a + n, b + n); equal < 8) return n + equal < most ? n + equal : most;
  return most;
}

/// The match of `position` with the position that lay in its bucket before it, if it is longer than `length`; it ends
/// at `end` at the latest. Most candidates differ in the four bytes that would make them so long, and are let go there.
/// Range  length ≥ shortest_match - 1.
GB_HD Match match_in(Bucket found, const std::uint8_t* bytes, std::uint32_t position, std::uint32_t end,
                     std::uint32_t length) {
  const std::uint32_t distance = distance_to(found, position);
  const std::uint32_t most = end - position < longest_match ? end - position : longest_match;
  if (!in_reach(distance) || length >= most) return {};
  const std::uint8_t *const here = bytes + position, *const tried = here + length + 1 - shortest_match;
  if (four_bytes(tried) != four_bytes(tried - distance)) return {};
  const std::uint32_t equal = equal_bytes(here, here - distance, most);
  return equal > length ? Match{equal, distance} : Match{};
}
GB_HD Match match_of(Token token) { return {token >> 16, token & 0xffff}; }

/// The positions of a chunk that are entered in the table are those that four bytes begin at: where they end, at most
/// at `end`.
GB_HD std::uint32_t entered_before(std::uint32_t chunk_bytes, std::uint32_t end) {
  const std::uint32_t all = chunk_bytes < shortest_match ? 0 : chunk_bytes - (shortest_match - 1);
  return all < end ? all : end;
}

/// Where the segment of `position` ends, in a block that ends at `block_end`.
GB_HD std::uint32_t segment_end(std::uint32_t position, std::uint32_t block_end) {
  const std::uint32_t end = (position / segment_bytes + 1) * segment_bytes;
  return end < block_end ? end : block_end;
}

/// Whether a literal and then `next` are better than the match `here`: no shorter, and a byte more is worth two bits of
/// the distance.
GB_HD bool better_one_later(const Match& here, const Match& next) {
  if (next.length < here.length) return false;
  const int bytes = int(next.length) - int(here.length);
  return 2 * bytes + int(floor_log2(here.distance)) - int(floor_log2(next.distance)) > 2;
}

/// The tokens of bytes [begin, end), in order, by `add(token)`. `match_at(p, end, length)` is match_in at p, or any
/// match that is no longer than `length`; it is asked for rising positions, and not for all.
template <class MatchAt, class Add>
GB_HD void parse_segment(const std::uint8_t* bytes, std::uint32_t begin, std::uint32_t end, MatchAt& match_at,
                         Add& add) {
  Match here = match_at(begin, end, shortest_match - 1);
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
    here = match_at(at, end, shortest_match - 1);
  }
}

}  // namespace gigabake::deflate
