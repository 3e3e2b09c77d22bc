#include "format/export/voxel_tiles/md5.h"

#include <bit>
#include <cmath>
#include <cstring>
#include <string>

namespace gigabake {
namespace {

using Md5State = std::array<std::uint32_t, 4>;

/// Returns the integer parts of 2³² · |sin(i + 1)|, as RFC 1321 defines them. Double precision is enough to get them
/// exactly.
const std::array<std::uint32_t, 64>& md5_sines() {
  static const std::array<std::uint32_t, 64> table = [] {
    std::array<std::uint32_t, 64> sines{};
    for (std::size_t i = 0; i < 64; ++i) sines[i] = std::uint32_t(std::abs(std::sin(double(i + 1))) * 4294967296.0);
    return sines;
  }();
  return table;
}

void add_md5_block(Md5State& state, const char* block) {
  constexpr int turns[4][4] = {{7, 12, 17, 22}, {5, 9, 14, 20}, {4, 11, 16, 23}, {6, 10, 15, 21}};
  constexpr std::uint32_t step[4] = {1, 5, 3, 7}, first[4] = {0, 1, 5, 0};
  std::uint32_t words[16];
  std::memcpy(words, block, 64);
  auto [a, b, c, d] = state;
  for (std::uint32_t i = 0; i < 64; ++i) {
    const std::uint32_t round = i / 16;
    const std::uint32_t mixed = round == 0   ? (b & c) | (~b & d)
                                : round == 1 ? (d & b) | (~d & c)
                                : round == 2 ? b ^ c ^ d
                                             : c ^ (b | ~d);
    const std::uint32_t sum = a + mixed + md5_sines()[i] + words[(step[round] * i + first[round]) % 16];
    a = d;
    d = c;
    c = b;
    b += std::rotl(sum, turns[round][i % 4]);
  }
  state = {state[0] + a, state[1] + b, state[2] + c, state[3] + d};
}

}  // namespace

std::array<std::uint8_t, 16> md5_of(std::string_view text) {
  std::string message(text);
  message += '\x80';
  message.resize((message.size() + 8 + 63) / 64 * 64 - 8, '\0');
  const std::uint64_t bits = 8 * std::uint64_t(text.size());
  message.append(reinterpret_cast<const char*>(&bits), 8);
  Md5State state{0x67452301, 0xefcdab89, 0x98badcfe, 0x10325476};
  for (std::size_t at = 0; at < message.size(); at += 64) add_md5_block(state, message.data() + at);
  std::array<std::uint8_t, 16> digest;
  std::memcpy(digest.data(), state.data(), 16);
  return digest;
}

}  // namespace gigabake
