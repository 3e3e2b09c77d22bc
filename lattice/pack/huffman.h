/// Code lengths of an alphabet from its counts, and the codes.
///
/// The rule: symbols that occur are ordered by count, equal ones by number. Huffman's tree is made with two queues, and
/// of equal weights a symbol is taken before a pair, which keeps the tree flat. Symbols deeper than the limit are
/// raised to it; while there are too many, one of the limit's symbols goes below the deepest that is shorter. The
/// rarest symbols, in that order, get the longest codes. An alphabet of which fewer than two symbols occur gets the
/// lowest ones that do not as well, so that each code is complete, as some readers demand.
///
/// Exact   Integers: host and device give the same codes.
/// Cost    Serial; about a dozen steps a symbol. The order is the caller's to make, as it likes.
/// Source  Moffat and Katajainen 1995, "In-place calculation of minimum-redundancy codes"; RFC 1951, 3.2.2.
#pragma once

#include <cstdint>

#include "lattice/host_device.h"
#include "lattice/pack/deflate_symbols.h"

namespace gigabake::deflate {

/// What symbols are ordered by; 0: does not occur. Range  count < 2^22, symbol < 512.
GB_HD std::uint32_t order_key(std::uint32_t count, std::uint32_t symbol) {
  return count == 0 ? 0 : count << 9 | symbol;
}
GB_HD std::uint32_t key_symbol(std::uint32_t key) { return key & 511; }
GB_HD std::uint32_t key_count(std::uint32_t key) { return key >> 9; }

/// Gives the lowest symbols a count of 1 until two occur.
GB_HD void ensure_two(std::uint32_t* counts, std::uint32_t symbols) {
  std::uint32_t used = 0;
  for (std::uint32_t s = 0; s < symbols && used < 2; ++s) used += counts[s] != 0;
  for (std::uint32_t s = 0; used < 2; ++s)
    if (counts[s] == 0) {
      counts[s] = 1;
      ++used;
    }
}

/// Turns rising weights into the depths of the tree's inner nodes: weights[0 … size - 2], the root last with depth 0.
/// Range  size ≥ 2.
GB_HD void inner_depths(std::uint32_t* weights, int size) {
  weights[0] += weights[1];
  int root = 0, leaf = 2;
  for (int next = 1; next < size - 1; ++next) {
    std::uint32_t sum = 0;
    for (int child = 0; child < 2; ++child) {
      if (leaf >= size || (root < next && weights[root] < weights[leaf])) {
        sum += weights[root];
        weights[root++] = std::uint32_t(next);
      } else {
        sum += weights[leaf++];
      }
    }
    weights[next] = sum;
  }
  weights[size - 2] = 0;
  for (int next = size - 3; next >= 0; --next) weights[next] = weights[weights[next]] + 1;
}

/// How many symbols have each length, from inner depths as above; the deep ones raised to `most`.
GB_HD void count_lengths(const std::uint32_t* inner, int size, std::uint32_t most, std::uint32_t* of_length) {
  for (std::uint32_t l = 0; l <= most; ++l) of_length[l] = 0;
  std::uint32_t places = 1;
  int root = size - 2;
  for (std::uint32_t depth = 0; places > 0; ++depth) {
    std::uint32_t nodes = 0;
    for (; root >= 0 && inner[root] == depth; --root) ++nodes;
    of_length[depth < most ? depth : most] += places - nodes;
    places = 2 * nodes;
  }
  std::uint32_t taken = 0;
  for (std::uint32_t l = 1; l <= most; ++l) taken += of_length[l] << (most - l);
  for (; taken > 1u << most; --taken) {
    std::uint32_t shorter = most - 1;
    while (of_length[shorter] == 0) --shorter;
    --of_length[most];
    --of_length[shorter];
    of_length[shorter + 1] += 2;
  }
}

/// The lengths of the symbols of `keys`, which rise; lengths of others are left alone. weights: room for `size`.
/// Range  2 ≤ size ≤ 2^most.
GB_HD void code_lengths(const std::uint32_t* keys, int size, std::uint32_t most, std::uint32_t* weights,
                        std::uint8_t* lengths) {
  for (int i = 0; i < size; ++i) weights[i] = key_count(keys[i]);
  inner_depths(weights, size);
  std::uint32_t of_length[longest_code + 1];
  count_lengths(weights, size, most, of_length);
  int at = 0;
  for (std::uint32_t length = most; length > 0; --length)
    for (std::uint32_t n = of_length[length]; n > 0; --n) lengths[key_symbol(keys[at++])] = std::uint8_t(length);
}

/// `code` of `length` bits, first bit lowest.
GB_HD std::uint32_t first_bit_lowest(std::uint32_t code, std::uint32_t length) {
#if defined(__CUDA_ARCH__)
  return __brev(code) >> (32 - length);
#else
  code = (code & 0x5555) << 1 | (code >> 1 & 0x5555);
  code = (code & 0x3333) << 2 | (code >> 2 & 0x3333);
  code = (code & 0x0f0f) << 4 | (code >> 4 & 0x0f0f);
  code = (code & 0x00ff) << 8 | (code >> 8 & 0x00ff);
  return code >> (16 - length);
#endif
}

/// The canonical codes of lengths, 0 where a length is 0.
GB_HD void assign_codes(const std::uint8_t* lengths, std::uint32_t symbols, Code* codes) {
  std::uint32_t of_length[longest_code + 1] = {}, next[longest_code + 1];
  for (std::uint32_t s = 0; s < symbols; ++s) ++of_length[lengths[s]];
  std::uint32_t code = 0;
  of_length[0] = next[0] = 0;
  for (std::uint32_t l = 1; l <= longest_code; ++l) next[l] = code = (code + of_length[l - 1]) << 1;
  for (std::uint32_t s = 0; s < symbols; ++s) {
    const std::uint32_t length = lengths[s];
    codes[s] = length == 0 ? 0 : length << 16 | first_bit_lowest(next[length]++, length);
  }
}

}  // namespace gigabake::deflate
