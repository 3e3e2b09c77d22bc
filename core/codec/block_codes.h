/// The codes and the header of a deflate block with dynamic codes, computed from symbol counts.
///
/// The header contains the code lengths of both alphabets as one sequence of runs. Each run becomes as few symbols as
/// possible. Runs of zeros are coded in parts of 11 to 138 zeros, then of 3 to 10. Repetitions of another length are
/// coded in parts of 3 to 6. The remaining lengths are coded singly.
///
/// Exact   Integers: host and device give the same bits.
/// Source  RFC 1951, 3.2.7.
#pragma once

#include <cstdint>

#include "core/base/host_device.h"
#include "core/codec/deflate_symbols.h"
#include "core/codec/huffman.h"

namespace gigabake::deflate {

/// The number of 32-bit words for the longest header. The longest header has 74 bits, then 7 bits and up to 7 extra
/// bits for each of 316 lengths: 141 words, rounded up to a multiple of 16.
inline constexpr std::uint32_t header_words = 144;

/// The codes and the header of a block.
struct BlockCodes {
  Code codes[block_symbols];
  std::uint32_t header_bits;
  std::uint32_t header[header_words];  ///< bit 0 of word 0 is the first bit
};

/// Temporary data of make_block_codes(); a device stores it in shared memory.
struct BlockWork {
  /// The sort keys of each alphabet, ascending: literals from index 0, distances from index literal_symbols.
  std::uint32_t keys[literal_symbols + distance_symbols];
  std::uint32_t used_literals, used_distances;  ///< number of keys of each alphabet
  std::uint32_t weights[literal_symbols];
  std::uint8_t lengths[block_symbols];
  /// The symbols that code the code lengths, and the extra bits of each symbol.
  std::uint8_t run[block_symbols], run_bits[block_symbols];
};

/// A writer of consecutive bits. It writes each word once.
class WordWriter {
 public:
  GB_HD explicit WordWriter(std::uint32_t* words) : words_(words) {}
  /// Appends `count` bits.
  /// Range   count ≤ 32, bits < 2^count.
  GB_HD void put(std::uint64_t bits, std::uint32_t count) {
    waiting_ |= bits << (count_ & 31);
    const std::uint32_t before = count_ >> 5;
    count_ += count;
    if (count_ >> 5 != before) {
      words_[before] = std::uint32_t(waiting_);
      waiting_ >>= 32;
    }
  }
  /// Writes the last, incomplete word. Returns the total number of bits.
  GB_HD std::uint32_t finish() {
    if ((count_ & 31) != 0) words_[count_ >> 5] = std::uint32_t(waiting_);
    return count_;
  }

 private:
  std::uint32_t* words_;
  std::uint32_t count_ = 0;
  std::uint64_t waiting_ = 0;
};

/// The symbols of the code-length alphabet. length_symbol_at() returns the symbol whose code length is number `place`
/// in the header.
inline constexpr std::uint32_t length_symbols = 19, repeat = 16, short_zeros = 17, long_zeros = 18;
GB_HD std::uint32_t length_symbol_at(std::uint32_t place) {
  constexpr std::uint8_t order[length_symbols] = {16, 17, 18, 0, 8, 7, 9, 6, 10, 5, 11, 4, 12, 3, 13, 2, 14, 1, 15};
  return order[place];
}

/// Writes one run of `count` equal lengths to work.run and work.run_bits from index `at` on. Returns the end of the
/// output.
GB_HD std::uint32_t put_run(BlockWork& work, std::uint32_t at, std::uint8_t length, std::uint32_t count) {
  const auto put = [&](std::uint32_t symbol, std::uint32_t bits) {
    work.run[at] = std::uint8_t(symbol);
    work.run_bits[at++] = std::uint8_t(bits);
  };
  if (length == 0) {
    for (; count >= 11; count -= count < 138 ? count : 138) put(long_zeros, (count < 138 ? count : 138) - 11);
    if (count >= 3) {
      put(short_zeros, count - 3);
      count = 0;
    }
  } else {
    put(length, 0);
    for (--count; count >= 3; count -= count < 6 ? count : 6) put(repeat, (count < 6 ? count : 6) - 3);
  }
  for (; count > 0; --count) put(length, 0);
  return at;
}

/// Returns the number of extra bits after a symbol of the code-length alphabet.
GB_HD std::uint32_t run_bit_count(std::uint32_t symbol) {
  return symbol == repeat ? 2 : symbol == short_zeros ? 3 : symbol == long_zeros ? 7 : 0;
}

/// Computes the codes of the code-length alphabet from the runs. Overwrites keys and weights of `work`.
GB_HD void make_length_codes(BlockWork& work, std::uint32_t runs, Code* codes, std::uint8_t* lengths) {
  std::uint32_t counts[length_symbols] = {};
  for (std::uint32_t i = 0; i < runs; ++i) ++counts[work.run[i]];
  ensure_two(counts, length_symbols);
  int used = 0;
  for (std::uint32_t s = 0; s < length_symbols; ++s) {
    lengths[s] = 0;
    if (counts[s] == 0) continue;
    int at = used++;
    const std::uint32_t key = order_key(counts[s], s);
    for (; at > 0 && work.keys[at - 1] > key; --at) work.keys[at] = work.keys[at - 1];
    work.keys[at] = key;
  }
  code_lengths(work.keys, used, 7, work.weights, lengths);
  assign_codes(lengths, length_symbols, codes);
}

/// Writes the code lengths of both alphabets as runs, literals first. Returns the number of symbols written.
GB_HD std::uint32_t put_runs(BlockWork& work, std::uint32_t literals, std::uint32_t distances) {
  const std::uint32_t all = literals + distances;
  const auto length_at = [&](std::uint32_t i) {
    return work.lengths[i < literals ? i : literal_symbols + (i - literals)];
  };
  std::uint32_t runs = 0;
  for (std::uint32_t i = 0; i < all;) {
    std::uint32_t end = i + 1;
    while (end < all && length_at(end) == length_at(i)) ++end;
    runs = put_run(work, runs, length_at(i), end - i);
    i = end;
  }
  return runs;
}

/// Writes the header of a block: its type, the lengths of the code-length codes, and the code lengths. `last` means
/// that the block is the last of its chunk.
GB_HD void write_header(BlockWork& work, bool last, BlockCodes& out) {
  std::uint32_t literals = literal_symbols, distances = distance_symbols;
  while (literals > end_of_block + 1 && work.lengths[literals - 1] == 0) --literals;
  while (distances > 1 && work.lengths[literal_symbols + distances - 1] == 0) --distances;
  const std::uint32_t runs = put_runs(work, literals, distances);
  Code codes[length_symbols];
  std::uint8_t lengths[length_symbols];
  make_length_codes(work, runs, codes, lengths);
  std::uint32_t places = length_symbols;
  while (places > 4 && lengths[length_symbol_at(places - 1)] == 0) --places;
  WordWriter writer(out.header);
  writer.put((last ? 1 : 0) | 2 << 1, 3);
  writer.put(literals - 257, 5);
  writer.put(distances - 1, 5);
  writer.put(places - 4, 4);
  for (std::uint32_t i = 0; i < places; ++i) writer.put(lengths[length_symbol_at(i)], 3);
  for (std::uint32_t i = 0; i < runs; ++i) {
    const Code code = codes[work.run[i]];
    writer.put(code_bits(code), code_length(code));
    writer.put(work.run_bits[i], run_bit_count(work.run[i]));
  }
  out.header_bits = writer.finish();
}

/// Computes the codes and the header from the sorted keys in `work`.
/// Range   Both alphabets have at least two keys (ensure_two).
GB_HD void make_block_codes(BlockWork& work, bool last, BlockCodes& out) {
  for (std::uint32_t s = 0; s < block_symbols; ++s) work.lengths[s] = 0;
  std::uint8_t* const of_distances = work.lengths + literal_symbols;
  code_lengths(work.keys, int(work.used_literals), max_code_bits, work.weights, work.lengths);
  code_lengths(work.keys + literal_symbols, int(work.used_distances), max_code_bits, work.weights, of_distances);
  assign_codes(work.lengths, literal_symbols, out.codes);
  assign_codes(of_distances, distance_symbols, out.codes + literal_symbols);
  write_header(work, last, out);
}

}  // namespace gigabake::deflate
