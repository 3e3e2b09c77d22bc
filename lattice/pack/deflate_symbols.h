/// Deflate's alphabets and how a token, which is a literal or a match, is written with them.
///
/// Exact   Integers: host and device give the same bits.
/// Source  RFC 1951, 3.2.5.
#pragma once

#include <bit>
#include <cstdint>

#include "lattice/host_device.h"

namespace gigabake::deflate {

inline constexpr std::uint32_t literal_symbols = 286, distance_symbols = 30, end_of_block = 256;
/// Literals and lengths first, then distances: counts and codes of a block stand in one array.
inline constexpr std::uint32_t block_symbols = literal_symbols + distance_symbols;
inline constexpr std::uint32_t longest_match = 258;

/// How many bits a number takes, less one. Range  value > 0.
GB_HD std::uint32_t floor_log2(std::uint32_t value) {
#if defined(__CUDA_ARCH__)
  return 31u - unsigned(__clz(int(value)));
#else
  return 31u - unsigned(std::countl_zero(value));
#endif
}

/// A symbol of a length or distance, and the bits that follow it.
struct SymbolAndBits {
  std::uint32_t symbol, bits, bit_count;
};

/// Range  3 ≤ length ≤ 258.
GB_HD SymbolAndBits symbol_of_length(std::uint32_t length) {
  const std::uint32_t above = length - 3;
  if (length == longest_match) return {285, 0, 0};
  if (above < 8) return {257 + above, 0, 0};
  const std::uint32_t bits = floor_log2(above) - 2;
  return {257 + 4 * bits + (above >> bits), above & ((1u << bits) - 1), bits};
}

/// A number among `block_symbols`. Range  1 ≤ distance ≤ 32768.
GB_HD SymbolAndBits symbol_of_distance(std::uint32_t distance) {
  const std::uint32_t above = distance - 1;
  if (above < 4) return {literal_symbols + above, 0, 0};
  const std::uint32_t bits = floor_log2(above) - 1;
  return {literal_symbols + 2 * bits + (above >> bits), above & ((1u << bits) - 1), bits};
}

/// A literal is its byte, the end of a block is 256, a match is its length << 16 | distance.
using Token = std::uint32_t;
GB_HD bool is_symbol(Token token) { return token <= end_of_block; }
GB_HD Token match_token(std::uint32_t length, std::uint32_t distance) { return length << 16 | distance; }

/// Counts the token's symbols by `add(symbol)`.
template <class Add>
GB_HD void count_symbols(Token token, const Add& add) {
  if (is_symbol(token)) return add(token);
  add(symbol_of_length(token >> 16).symbol);
  add(symbol_of_distance(token & 0xffff).symbol);
}

/// A symbol's code, first bit lowest, and its length << 16; 0: has none.
using Code = std::uint32_t;
inline constexpr std::uint32_t longest_code = 15;
GB_HD std::uint32_t code_bits(Code code) { return code & 0xffff; }
GB_HD std::uint32_t code_length(Code code) { return code >> 16; }

/// Up to 48 bits, first bit lowest.
struct Bits {
  std::uint64_t bits;
  std::uint32_t count;
};

/// What the token is written as. Range  `codes` has block_symbols, and codes for the token's.
GB_HD Bits bits_of(Token token, const Code* codes) {
  if (is_symbol(token)) return {code_bits(codes[token]), code_length(codes[token])};
  const SymbolAndBits length = symbol_of_length(token >> 16), distance = symbol_of_distance(token & 0xffff);
  const Code first = codes[length.symbol], second = codes[distance.symbol];
  std::uint64_t bits = code_bits(first);
  std::uint32_t count = code_length(first);
  bits |= std::uint64_t(length.bits) << count;
  count += length.bit_count;
  bits |= std::uint64_t(code_bits(second)) << count;
  count += code_length(second);
  bits |= std::uint64_t(distance.bits) << count;
  return {bits, count + distance.bit_count};
}

}  // namespace gigabake::deflate
