#include "format/shard/hdf5/hdf5_rows.h"

#include <gtest/gtest.h>
#include <random>
#include <thread>

#include "core/codec/chunk_rows.h"
#include "tests/format/shard/made_shard.h"
#include "tests/random_seed.h"

namespace gigabake {
namespace {

const Hdf5Column column_of_bytes{"/bytes", Hdf5Type::u8, 1};

void write_column(const std::filesystem::path& path, std::span<const std::uint8_t> rows) {
  ColumnRows column{"", column_of_bytes, rows.size(), {}};
  column.get = [rows](std::uint64_t first, std::uint64_t count, auto&) { return rows.subspan(first, count); };
  Hdf5File file = Hdf5File::create(path, path);
  file.write_columns(std::span(&column, 1), Codec::deflate, callers_thread());
  file.close();
}

/// Chunks of columns with few chunks are located when the column is opened, the others at their first use.
TEST(Hdf5Rows, AreTheWrittenRowsIfTheColumnHasFewOrManyChunks) {
  const test::RandomSeed seed;
  std::mt19937_64 rng(seed);
  const made::TempFolder folder;
  for (const std::size_t chunks : {1, 2, 16, 17, 40}) {
    std::vector<std::uint8_t> written((chunks - 1) * (128 << 10) + 1 + rng() % (128 << 10));
    for (std::uint8_t& byte : written) byte = std::uint8_t(rng() % 3);
    ASSERT_EQ(chunk_count(written.size(), 1), chunks);
    write_column(folder / "rows.h5", written);
    const Hdf5File file = Hdf5File::open(folder / "rows.h5", ChunkPlaces::by_index);
    const Hdf5Rows rows(file, column_of_bytes);
    ASSERT_EQ(rows.rows(), written.size());
    std::vector<std::jthread> readers;
    for (int t = 0; t < 3; ++t)
      readers.emplace_back([&, random = std::mt19937_64(rng())]() mutable {
        for (int range = 0; range < 20; ++range) {
          const std::size_t first = random() % written.size(), count = random() % (written.size() - first);
          std::vector<std::uint8_t> read(count);
          rows.read(first, count, read.data());
          EXPECT_TRUE(std::equal(read.begin(), read.end(), written.begin() + std::ptrdiff_t(first)))
              << chunks << " chunks, rows from " << first;
        }
      });
  }
}

}  // namespace
}  // namespace gigabake
