#include "format/shard/hdf5/chunk_table.h"

#include <barrier>
#include <gtest/gtest.h>
#include <hdf5.h>
#include <random>
#include <stdexcept>
#include <thread>

#include "core/base/error.h"
#include "core/base/work_counts.h"
#include "core/codec/chunk_rows.h"
#include "format/shard/hdf5/hdf5_rows.h"
#include "format/shard/levels/content_hash.h"
#include "format/shard/shard_pages.h"
#include "format/shard/shard_reader.h"
#include "tests/format/shard/made_shard.h"
#include "tests/random_seed.h"

namespace gigabake {
namespace {

ChunkTable random_table(std::mt19937_64& rng) {
  ChunkTable table;
  for (int c = 0, count = int(rng() % 5); c < count; ++c) {
    ChunkedColumn column{rng() % 3 * (rng() % 1000), 0, 1 + rng() % 8, Codec::lz4, false, {}};
    if (column.rows != 0)
      column.chunk_rows = 1 + rng() % column.rows, column.codec = Codec(rng() % 2), column.is_shuffled = rng() % 2 == 0;
    table.add("/column_" + std::to_string(c), column);
    for (std::uint64_t chunk = 0; chunk < column.chunk_count(); ++chunk) table.add_chunk({rng(), rng()});
  }
  return table;
}

TEST(ChunkTable, HasTheColumnsOfItsStoredForm) {
  const test::RandomSeed seed;
  std::mt19937_64 rng(seed);
  for (int round = 0; round < 200; ++round) {
    const ChunkTable table = random_table(rng);
    const ChunkTable again(table.stored());
    ASSERT_TRUE(std::ranges::equal(again.names(), table.names()));
    for (const std::string& name : table.names()) EXPECT_EQ(*again.find(name), *table.find(name));
    EXPECT_EQ(again.find("/column"), nullptr);
  }
}

TEST(ChunkTable, RejectsNamesAndNumbersThatDoNotMatch) {
  const test::RandomSeed seed;
  std::mt19937_64 rng(seed);
  for (int round = 0; round < 200; ++round) {
    const ChunkTable::Stored good = random_table(rng).stored();
    const auto expect_rejected = [&](const auto& spoil) {
      ChunkTable::Stored bad = good;
      spoil(bad);
      EXPECT_THROW(ChunkTable{bad}, std::invalid_argument);
    };
    expect_rejected([](ChunkTable::Stored& table) { table.numbers.push_back(0); });
    expect_rejected([](ChunkTable::Stored& table) { table.names += " /more"; });
    expect_rejected([&](ChunkTable::Stored& table) {
      table.names += (table.names.empty() ? "/a /a" : " " + table.names);
      table.numbers.insert(table.numbers.end(), good.numbers.begin(), good.numbers.end());
      if (good.numbers.empty()) table.numbers.resize(8);
    });
    if (good.numbers.empty()) continue;
    expect_rejected([&](ChunkTable::Stored& table) { table.numbers.resize(rng() % table.numbers.size()); });
    expect_rejected([](ChunkTable::Stored& table) { table.numbers[3] = 4; });
    expect_rejected([](ChunkTable::Stored& table) { table.numbers[1] = table.numbers[0] == 0 ? 1 : 0; });
    expect_rejected([](ChunkTable::Stored& table) { table.numbers[0] = ~std::uint64_t(0), table.numbers[1] = 1; });
  }
}

/// Columns of bytes with the given numbers of rows.
class TableOfFile : public testing::Test {
 protected:
  static Hdf5Column column(std::size_t c) { return {"/column_" + std::to_string(c), Hdf5Type::u8, 1}; }

  void write(Hdf5File file, const std::vector<std::vector<std::uint8_t>>& rows) {
    std::vector<ColumnRows> columns;
    for (std::size_t c = 0; c < rows.size(); ++c)
      columns.push_back({"", column(c), rows[c].size(), [&rows, c](std::uint64_t first, std::uint64_t count, auto&) {
                           return std::span(rows[c]).subspan(first, count);
                         }});
    file.write_columns(columns, Codec::deflate, callers_thread());
    file.write_chunk_table(Codec::deflate);
    file.close();
  }

  const made::TempFolder folder_;
  const std::filesystem::path path_ = folder_ / "file.h5";
};

TEST_F(TableOfFile, AgreesWithTheIndexesOfFilesOnDiskAndInMemory) {
  const test::RandomSeed seed;
  std::mt19937_64 rng(seed);
  std::vector<std::vector<std::uint8_t>> rows(5);
  const std::size_t chunks[] = {0, 1, 3, 17, 40};
  for (std::size_t c = 1; c < rows.size(); ++c) {
    rows[c].resize((chunks[c] - 1) * (128 << 10) + 1 + rng() % (128 << 10));
    for (std::uint8_t& byte : rows[c]) byte = std::uint8_t(rng() % 3);
  }
  for (const bool in_memory : {false, true}) {
    FileImage image;
    write(in_memory ? Hdf5File::create(image, path_) : Hdf5File::create(path_, path_), rows);
    if (in_memory) {
      ASSERT_TRUE(image.write_to(Descriptor(path_, O_WRONLY | O_CREAT | O_TRUNC)));
    }
    const Hdf5File file = Hdf5File::open(path_, ChunkPlaces::by_table),
                   by_index = Hdf5File::open(path_, ChunkPlaces::by_index);
    for (std::size_t c = 0; c < rows.size(); ++c) {
      const ChunkedColumn* found = file.chunk_table()->find(column(c).name);
      ASSERT_NE(found, nullptr);
      EXPECT_EQ(found->chunks.size(), chunks[c]);
      EXPECT_EQ(*found, IndexedColumn(by_index, column(c)).with_chunks());
      std::vector<std::uint8_t> read(rows[c].size());
      Hdf5Rows(file, column(c)).read(0, read.size(), read.data());
      EXPECT_EQ(read, rows[c]);
    }
  }
}

TEST_F(TableOfFile, IsReadOnceByManyThreads) {
  write(Hdf5File::create(path_, path_), {{1, 2, 3}, {4, 5}});
  for (int round = 0; round < 20; ++round) {
    const WorkCounts before = work_counts();
    const Hdf5File file = Hdf5File::open(path_, ChunkPlaces::by_table);
    std::barrier start{4};
    std::vector<std::jthread> readers;
    for (int t = 0; t < 4; ++t)
      readers.emplace_back([&] {
        start.arrive_and_wait();
        std::uint8_t row = 0;
        Hdf5Rows(file, column(1)).read(1, 1, &row);
        EXPECT_EQ(row, 5);
      });
    readers.clear();
    EXPECT_EQ(work_counts().since(before)[WorkCounter::shard_datasets_opened], 1u);
  }
}

/// A file whose table is made by the test.
class MadeTable : public TableOfFile {
 protected:
  static ColumnRows rows_of(const Hdf5Column& column, std::span<const std::uint8_t> bytes) {
    const std::size_t width = column.row_bytes();
    return {"", column, bytes.size() / width, [=](std::uint64_t first, std::uint64_t count, auto&) {
              return bytes.subspan(first * width, count * width);
            }};
  }

  /// Writes a column of 1,000 bytes, and a table after `spoil` has changed the column's entry.
  void write(const std::function<void(ChunkedColumn&)>& spoil) {
    const std::vector<std::uint8_t> bytes(1000, 7);
    const ColumnRows rows = rows_of(column(0), bytes);
    Hdf5File plain = Hdf5File::create(path_, path_);
    plain.write_columns(std::span(&rows, 1), Codec::deflate, callers_thread());
    plain.close();
    ChunkedColumn shape = IndexedColumn(Hdf5File::open(path_, ChunkPlaces::by_index), column(0)).with_chunks();
    spoil(shape);
    ChunkTable table;
    table.add(column(0).name, shape);
    const ChunkTable::Stored stored = table.stored();
    const auto* numbers = reinterpret_cast<const std::uint8_t*>(stored.numbers.data());
    const ColumnRows of_table =
        rows_of({"/chunks", Hdf5Type::u64, 1, BytePlanes::of_elements}, std::span(numbers, 8 * stored.numbers.size()));
    Hdf5File file = Hdf5File::create(path_, path_);
    file.write_columns(std::vector{rows, of_table}, Codec::deflate, callers_thread());
    file.write_attribute("columns", stored.names);
    file.close();
  }

  std::string message_of_reading() const {
    try {
      const Hdf5File file = Hdf5File::open(path_, ChunkPlaces::by_table);
      std::vector<std::uint8_t> read(1000);
      Hdf5Rows(file, column(0)).read(0, read.size(), read.data());
      return "";
    } catch (const InputError& error) {
      return error.what();
    }
  }
};

TEST_F(MadeTable, IsRefusedIfItsPlacesAreNotThoseOfTheChunks) {
  write([](ChunkedColumn&) {});
  EXPECT_EQ(message_of_reading(), "");
  const std::vector<std::pair<const char*, std::function<void(ChunkedColumn&)>>> damages{
      {"row 0: the checksum is wrong", [](ChunkedColumn& shape) { ++shape.chunks[0].offset; }},
      {"row 0: the checksum is wrong", [](ChunkedColumn& shape) { --shape.chunks[0].bytes; }},
      {"row 0: the chunk is missing or damaged", [](ChunkedColumn& shape) { shape.chunks[0].offset = 1 << 30; }},
      {"more than its stored bytes can hold", [](ChunkedColumn& shape) { shape.chunks[0].bytes = 0; }},
      {"row 0: the checksum is wrong", [](ChunkedColumn& shape) { shape.rows = shape.chunk_rows = 999; }},
      {"not stored in the expected chunks", [](ChunkedColumn& shape) { shape.chunk_rows = 1001; }},
      {"has another shape than expected", [](ChunkedColumn& shape) { shape.row_bytes = 2; }},
      {"row 0: the checksum is wrong", [](ChunkedColumn& shape) { shape.codec = Codec::lz4; }},
      {"/chunks: does not match the attribute 'columns'", [](ChunkedColumn& shape) { shape.chunks.clear(); }},
  };
  for (const auto& [message, damage] : damages) {
    write(damage);
    EXPECT_NE(message_of_reading().find(message), std::string::npos) << message << ": " << message_of_reading();
  }
}

TEST(ChunkTableOfAShard, SavesOpeningTheDatasets) {
  const test::RandomSeed seed;
  std::mt19937_64 rng(seed);
  const made::TempFolder folder;
  write_shard(folder / "s.h5", made::random_shard(rng, {.lods = 5, .nested = true}), {});
  const WorkCounts before = work_counts();
  const ShardPages pages(folder / "s.h5");
  for (int lod = 0; lod < 5; ++lod)
    for (std::uint64_t brick = 0; brick < pages.bricks(lod); brick += 64) pages.level(lod, brick, 64);
  EXPECT_EQ(work_counts().since(before)[WorkCounter::shard_datasets_opened], 1u);
}

/// A check opens each dataset once. Later reads do not open datasets.
TEST(ChunkTableOfAShard, ReplacesTheIndexesOnceItWasCompared) {
  const test::RandomSeed seed;
  std::mt19937_64 rng(seed);
  const made::TempFolder folder;
  const Shard written = made::random_shard(rng, {.lods = 5, .nested = true});
  write_shard(folder / "s.h5", written, {});
  ShardReader by_index(folder / "s.h5"), checked(folder / "s.h5");
  EXPECT_EQ(checked.check_chunk_table(), std::vector<std::string>());
  const WorkCounts before = work_counts();
  EXPECT_EQ(content_hash(checked.all()), content_hash(written));
  EXPECT_EQ(work_counts().since(before)[WorkCounter::shard_datasets_opened], 0u);
  for (int lod = 0; lod < 5; ++lod) EXPECT_EQ(checked.level_bytes(lod), by_index.level_bytes(lod)) << lod;
  EXPECT_EQ(checked.node_bytes(), by_index.node_bytes());
}

/// Renames datasets with HDF5 itself, as another program could.
TEST(ChunkTableOfAShard, IsComparedWithTheIndexes) {
  const made::TempFolder folder;
  write_shard(folder / "s.h5", made::small_shard(), {});
  EXPECT_EQ(ShardReader(folder / "s.h5").check_chunk_table(), std::vector<std::string>());
  const hid_t file = H5Fopen((folder / "s.h5").c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
  for (const auto& [from, to] :
       {std::pair("/nodes/lod", "/nodes/l"), {"/nodes/child_mask", "/nodes/lod"}, {"/nodes/l", "/nodes/child_mask"}})
    ASSERT_GE(H5Lmove(file, from, H5L_SAME_LOC, to, H5P_DEFAULT, H5P_DEFAULT), 0);
  H5Fclose(file);
  const std::vector<std::string> faults = ShardReader(folder / "s.h5").check_chunk_table();
  ASSERT_EQ(faults.size(), 2u);
  EXPECT_NE(faults[0].find("/chunks: does not match the dataset /nodes/lod"), std::string::npos) << faults[0];
  EXPECT_NE(faults[1].find("/chunks: does not match the dataset /nodes/child_mask"), std::string::npos) << faults[1];
}

TEST(ChunkTableOfAShard, IsNotComparedWithTheChunksOfADamagedShape) {
  const made::TempFolder folder;
  write_shard(folder / "s.h5", made::small_shard(), {});
  const hid_t file = H5Fopen((folder / "s.h5").c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
  ASSERT_GE(H5Ldelete(file, "/nodes/lod", H5P_DEFAULT), 0);
  const hsize_t rows = hsize_t(1) << 40, chunk = 1;
  const hid_t space = H5Screate_simple(1, &rows, nullptr), properties = H5Pcreate(H5P_DATASET_CREATE);
  H5Pset_chunk(properties, 1, &chunk);
  H5Pset_deflate(properties, 1);
  H5Pset_fletcher32(properties);
  const hid_t set = H5Dcreate2(file, "/nodes/lod", H5T_STD_U8LE, space, H5P_DEFAULT, properties, H5P_DEFAULT);
  ASSERT_GE(set, 0);
  H5Dclose(set);
  H5Fclose(file);
  const std::vector<std::string> faults = ShardReader(folder / "s.h5").check_chunk_table();
  ASSERT_EQ(faults.size(), 1u);
  EXPECT_NE(faults[0].find("/chunks: does not match the dataset /nodes/lod"), std::string::npos) << faults[0];
}

}  // namespace
}  // namespace gigabake
