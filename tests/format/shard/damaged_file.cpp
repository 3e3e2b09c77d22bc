#include "damaged_file.h"

#include <algorithm>
#include <fstream>
#include <random>

#include "made_shard.h"

namespace gigabake::made {

void for_each_changed_byte(const std::filesystem::path& path, std::uint64_t seed, const Damage& damage) {
  std::mt19937_64 rng(seed);
  const std::string whole = bytes_of(path);
  std::fstream file(path, std::ios::binary | std::ios::in | std::ios::out);
  for (std::size_t at = 0; at < whole.size(); at += 1 + rng() % 3) {
    const char changed = rng() % 4 != 0 ? char(whole[at] ^ (1 << rng() % 8)) : char(rng());
    file.seekp(std::streamoff(at)).put(changed).flush();
    damage("seed " + std::to_string(seed) + ": byte " + std::to_string(at) + " is " + std::to_string(int(changed)));
    file.seekp(std::streamoff(at)).put(whole[at]).flush();
  }
}

void for_each_overwritten_stretch(const std::filesystem::path& path, std::uint64_t seed, const Damage& damage) {
  std::mt19937_64 rng(seed);
  const std::string whole = bytes_of(path);
  for (int round = 0; round < 300; ++round) {
    std::string damaged = whole;
    const std::size_t at = rng() % damaged.size(), size = 1 + rng() % 600;
    for (std::size_t i = at; i < std::min(damaged.size(), at + size); ++i)
      damaged[i] = round % 3 == 0 ? '\0' : round % 3 == 1 ? '\xff' : char(rng());
    std::ofstream(path, std::ios::binary) << damaged;
    damage("seed " + std::to_string(seed) + ", round " + std::to_string(round) + ", byte " + std::to_string(at));
  }
}

void for_each_cut(const std::filesystem::path& path, const Damage& damage) {
  for (std::uintmax_t size = std::filesystem::file_size(path); size-- > 0; size -= size / 97) {
    std::filesystem::resize_file(path, size);
    damage("cut to " + std::to_string(size) + " bytes");
  }
}

}  // namespace gigabake::made
