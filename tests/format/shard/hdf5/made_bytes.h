/// Test data for packers: difficult cases, and bytes like the columns of shards.
#pragma once

#include <algorithm>
#include <cstdint>
#include <random>
#include <string>
#include <utility>
#include <vector>

namespace gigabake::test {

using Bytes = std::vector<std::uint8_t>;
using Random = std::mt19937_64;

inline Bytes noise(Random& rng, std::size_t size, unsigned values) {
  Bytes bytes(size);
  for (std::uint8_t& b : bytes) b = std::uint8_t(rng() % values);
  return bytes;
}

/// Returns `period` random bytes, repeated, with some bits flipped.
inline Bytes periodic(Random& rng, std::size_t size, std::size_t period) {
  Bytes bytes = noise(rng, size, 256);
  for (std::size_t i = period; i < size; ++i) bytes[i] = bytes[i - period];
  for (std::size_t n = size / 5000; n > 0; --n) bytes[rng() % size] ^= 1;
  return bytes;
}

/// Returns runs of up to `maximum` equal bytes.
inline Bytes runs(Random& rng, std::size_t size, std::size_t maximum) {
  Bytes bytes;
  while (bytes.size() < size) bytes.insert(bytes.end(), 1 + rng() % maximum, std::uint8_t(rng()));
  bytes.resize(size);
  return bytes;
}

/// Returns the colours of a smooth image with noise. Some colours repeat earlier colours.
inline Bytes colours(Random& rng, std::size_t size) {
  Bytes bytes;
  int grey = 128;
  while (bytes.size() < size) {
    grey = std::clamp(grey + int(rng() % 7) - 3, 8, 240);
    const std::size_t back = 3 * (1 + rng() % 400);
    const bool again = rng() % 3 == 0 && back <= bytes.size();
    for (int c = 0; c < 3; ++c)
      bytes.push_back(again ? bytes[bytes.size() - back] : std::uint8_t(grey + c * 5 + int(rng() % 2)));
  }
  bytes.resize(size);
  return bytes;
}

/// Returns shuffled symbols whose counts are Fibonacci numbers: their Huffman tree is deeper than deflate allows.
inline Bytes fibonacci(Random& rng, std::size_t size) {
  Bytes bytes;
  for (std::size_t a = 1, b = 1, symbol = 0; bytes.size() < size; ++symbol, b = std::exchange(a, a + b))
    bytes.insert(bytes.end(), std::min(a, size - bytes.size()), std::uint8_t(symbol * 7));
  std::shuffle(bytes.begin(), bytes.end(), rng);
  return bytes;
}

/// Returns increasing numbers of eight bytes.
inline Bytes rising(Random& rng, std::size_t size) {
  Bytes bytes(size);
  std::uint64_t number = rng() % 1000;
  for (std::size_t i = 0; i < size; ++i) {
    if (i % 8 == 0) number += rng() % 300;
    bytes[i] = std::uint8_t(number >> 8 * (i % 8));
  }
  return bytes;
}

/// Returns half noise and half zeros, so that a chunk has compressed and stored blocks.
inline Bytes half_noise(Random& rng, std::size_t size) {
  Bytes bytes = noise(rng, size, 256);
  std::fill(bytes.begin() + std::ptrdiff_t(size / 2), bytes.end(), std::uint8_t(0));
  return bytes;
}

struct NamedBytes {
  std::string name;
  Bytes bytes;
};

/// Returns one example of each type of test data, with `size` bytes each.
inline std::vector<NamedBytes> made_bytes(Random& rng, std::size_t size) {
  std::vector<NamedBytes> all{{"zeros", Bytes(size)},
                              {"constant", Bytes(size, 0xab)},
                              {"noise", noise(rng, size, 256)},
                              {"two values", noise(rng, size, 2)},
                              {"forty values", noise(rng, size, 40)},
                              {"short runs", runs(rng, size, 9)},
                              {"long runs", runs(rng, size, 5000)},
                              {"colours", colours(rng, size)},
                              {"Fibonacci counts", fibonacci(rng, size)},
                              {"rising numbers", rising(rng, size)},
                              {"half noise", half_noise(rng, size)}};
  for (const std::size_t period :
       {1, 2, 3, 4, 5, 7, 64, 257, 258, 259, 1024, 4099, 32766, 32767, 32768, 32769, 65535, 65536, 65537, 70000})
    all.push_back({"period " + std::to_string(period), periodic(rng, size, period)});
  all.push_back({"random period", periodic(rng, size, 1 + rng() % 70000)});
  return all;
}

/// Returns sizes close to the limits of deflate: segments, blocks, stored blocks and the window.
inline const std::vector<std::size_t>& awkward_sizes() {
  static const std::vector<std::size_t> sizes{
      0,     1,     2,     3,     4,     5,     7,     8,     9,     100,    1023,   1024,   1025,   1027,    32767,
      32768, 32769, 32771, 33793, 65535, 65536, 65537, 98303, 98309, 131069, 131072, 131073, 200001, 1048576, 1048579};
  return sizes;
}

}  // namespace gigabake::test
