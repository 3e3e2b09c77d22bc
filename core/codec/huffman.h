/// Code lengths of an alphabet from its symbol counts, and the codes.
///
/// The symbols with non-zero counts are sorted by count, then by number. Two queues build Huffman's tree. If weights
/// are equal, a symbol is taken before a pair, which keeps the tree flat. Symbols deeper than the limit are raised to
/// the limit. While too many symbols are at the limit, one of them becomes the sibling of the deepest shorter symbol.
/// The rarest symbols, in sort order, get the longest codes. If fewer than two symbols occur, the lowest unused symbols
/// get a code too, because some readers require complete codes.
///
/// Exact   Integers: host and device give the same codes.
/// Cost    Serial; about 12 steps per symbol. The caller sorts the symbols.
/// Source  Moffat and Katajainen 1995, "In-place calculation of minimum-redundancy codes"; RFC 1951, 3.2.2.
#pragma once

#include <cstdint>

#include "core/base/host_device.h"
#include "core/codec/deflate_symbols.h"

namespace gigabake::deflate {

/// Returns the sort key of a symbol; 0 if the symbol does not occur.
/// Range   count < 2^22, symbol < 512.
GB_HD std::uint32_t order_key(std::uint32_t count, std::uint32_t symbol) {
  return count == 0 ? 0 : count << 9 | symbol;
}
GB_HD std::uint32_t key_symbol(std::uint32_t key) { return key & 511; }
GB_HD std::uint32_t key_count(std::uint32_t key) { return key >> 9; }

/// Sets the counts of the lowest unused symbols to 1 until two symbols occur.
GB_HD void ensure_two(std::uint32_t* counts, std::uint32_t symbols) {
  std::uint32_t used = 0;
  for (std::uint32_t s = 0; s < symbols && used < 2; ++s) used += counts[s] != 0;
  for (std::uint32_t s = 0; used < 2; ++s)
    if (counts[s] == 0) {
      counts[s] = 1;
      ++used;
    }
}

/// Builds Huffman's tree in place. Before the call, `weights` holds the weights of `size` leaves in ascending order.
/// After it, the first size - 1 entries hold the depths of the inner nodes. The last of these entries is the root's, 0.
/// Range   size ≥ 2.
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

/// Counts the symbols of each code length from the depths of inner_depths(). Limits lengths to `maximum`.
GB_HD void count_lengths(const std::uint32_t* inner, int size, std::uint32_t maximum, std::uint32_t* of_length) {
  for (std::uint32_t l = 0; l <= maximum; ++l) of_length[l] = 0;
  std::uint32_t places = 1;
  int root = size - 2;
  for (std::uint32_t depth = 0; places > 0; ++depth) {
    std::uint32_t nodes = 0;
    for (; root >= 0 && inner[root] == depth; --root) ++nodes;
    of_length[depth < maximum ? depth : maximum] += places - nodes;
    places = 2 * nodes;
  }
  std::uint32_t taken = 0;
  for (std::uint32_t l = 1; l <= maximum; ++l) taken += of_length[l] << (maximum - l);
  for (; taken > 1u << maximum; --taken) {
    std::uint32_t shorter = maximum - 1;
    while (of_length[shorter] == 0) --shorter;
    --of_length[maximum];
    --of_length[shorter];
    of_length[shorter + 1] += 2;
  }
}

/// Computes the code lengths of the symbols in `keys`. Does not write the lengths of other symbols. `weights` is
/// temporary memory for `size` entries.
/// Range   The keys ascend; 2 ≤ size ≤ 2^maximum.
GB_HD void code_lengths(const std::uint32_t* keys, int size, std::uint32_t maximum, std::uint32_t* weights,
                        std::uint8_t* lengths) {
  for (int i = 0; i < size; ++i) weights[i] = key_count(keys[i]);
  inner_depths(weights, size);
  std::uint32_t of_length[max_code_bits + 1];
  count_lengths(weights, size, maximum, of_length);
  int at = 0;
  for (std::uint32_t length = maximum; length > 0; --length)
    for (std::uint32_t n = of_length[length]; n > 0; --n) lengths[key_symbol(keys[at++])] = std::uint8_t(length);
}

/// Reverses the `length` bits of `code`: the first bit becomes the lowest.
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

/// Computes the canonical codes of `lengths`; a length of 0 gives code 0.
GB_HD void assign_codes(const std::uint8_t* lengths, std::uint32_t symbols, Code* codes) {
  std::uint32_t of_length[max_code_bits + 1] = {}, next[max_code_bits + 1];
  for (std::uint32_t s = 0; s < symbols; ++s) ++of_length[lengths[s]];
  std::uint32_t code = 0;
  of_length[0] = next[0] = 0;
  for (std::uint32_t l = 1; l <= max_code_bits; ++l) next[l] = code = (code + of_length[l - 1]) << 1;
  for (std::uint32_t s = 0; s < symbols; ++s) {
    const std::uint32_t length = lengths[s];
    codes[s] = length == 0 ? 0 : length << 16 | first_bit_lowest(next[length]++, length);
  }
}

}  // namespace gigabake::deflate
