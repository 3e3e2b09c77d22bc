#include <fstream>
#include <gtest/gtest.h>

#include "format/error.h"
#include "format/shard.h"
#include "made_shard.h"

namespace gigabake {
namespace {

using made::TempFolder;

/// Either an error or exactly what was written; anything else is a lie.
void expect_error_or_equal(const std::filesystem::path& path, const Shard& written, const std::string& what) {
  try {
    EXPECT_EQ(made::difference(written, read_shard(path)), "") << what;
  } catch (const InputError& error) {
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << what << ": " << error.what();
  }
}

TEST(HostileShard, WithAFlippedBitIsAnErrorOrReadsAsBefore) {
  const std::uint64_t seed = std::random_device{}();
  std::mt19937_64 rng(seed);
  const TempFolder folder;
  const Shard shard = made::small_shard();
  write_shard(folder / "s.h5", shard, {1});
  const std::string whole = made::bytes_of(folder / "s.h5");
  std::fstream file(folder / "s.h5", std::ios::binary | std::ios::in | std::ios::out);
  for (std::size_t at = 0; at < whole.size(); at += 1 + rng() % 4) {
    const int bit = int(rng() % 8);
    file.seekp(std::streamoff(at)).put(char(whole[at] ^ (1 << bit))).flush();
    expect_error_or_equal(
        folder / "s.h5", shard,
        "seed " + std::to_string(seed) + ": bit " + std::to_string(bit) + " of byte " + std::to_string(at));
    file.seekp(std::streamoff(at)).put(whole[at]).flush();
  }
}

TEST(HostileShard, WithAnOverwrittenStretchIsAnErrorOrReadsAsBefore) {
  const std::uint64_t seed = std::random_device{}();
  std::mt19937_64 rng(seed);
  const TempFolder folder;
  const Shard shard = made::random_shard(rng, {3, true, 3, rng() % 2 == 0});
  write_shard(folder / "s.h5", shard, {1});
  const std::string whole = made::bytes_of(folder / "s.h5");
  for (int round = 0; round < 300; ++round) {
    std::string damaged = whole;
    const std::size_t at = rng() % damaged.size(), size = 1 + rng() % 600;
    for (std::size_t i = at; i < std::min(damaged.size(), at + size); ++i)
      damaged[i] = round % 3 == 0 ? '\0' : round % 3 == 1 ? '\xff' : char(rng());
    std::ofstream(folder / "s.h5", std::ios::binary) << damaged;
    expect_error_or_equal(
        folder / "s.h5", shard,
        "seed " + std::to_string(seed) + ", round " + std::to_string(round) + ", byte " + std::to_string(at));
  }
}

TEST(HostileShard, CutAnywhereIsAnError) {
  const TempFolder folder;
  const Shard shard = made::small_shard();
  write_shard(folder / "s.h5", shard, {1});
  for (std::uintmax_t size = std::filesystem::file_size(folder / "s.h5"); size-- > 0; size -= size / 97) {
    std::filesystem::resize_file(folder / "s.h5", size);
    EXPECT_THROW(read_shard(folder / "s.h5"), InputError) << size;
  }
}

}  // namespace
}  // namespace gigabake
