// Levels since version 7: differences are lossless, and columns that contradict each other are refused.
#include "format/shard/columns/predicted_level.h"

#include <algorithm>
#include <functional>
#include <gtest/gtest.h>
#include <random>

#include "core/base/error.h"
#include "core/codec/prediction.h"
#include "format/shard/columns/packed_columns.h"
#include "format/shard/shard_layout.h"
#include "format/shard/shard_pages.h"
#include "format/shard/shard_reader.h"
#include "format/shard/splice/base_shard.h"
#include "made_shard.h"
#include "packed_by_hand.h"
#include "tests/random_seed.h"

namespace gigabake {
namespace {

using made::PackedByHand;
using RowBytes = PackedByHand::Bytes;

TEST(Prediction, OfColoursAndNormalsIsReversibleForAllBytes) {
  const test::RandomSeed seed;
  std::mt19937_64 rng(seed);
  for (std::uint32_t difference = 0; difference < 1u << 24; difference += 1 + std::uint32_t(rng() % 7)) {
    const auto predicted = std::uint32_t(rng());
    const std::uint32_t rgb = colour_from_difference(difference, predicted);
    ASSERT_LT(rgb, 1u << 24);
    ASSERT_EQ(colour_difference(rgb, predicted), difference);
  }
  for (std::uint32_t normal = 0; normal < 1u << 16; ++normal) {
    const auto predicted = std::uint16_t(rng());
    ASSERT_EQ(normal_from_difference(normal_difference(normal, predicted), predicted), normal);
  }
}

TEST(Prediction, NumbersVoxelsByInterleavedCoordinates) {
  const test::RandomSeed seed;
  std::mt19937_64 rng(seed);
  for (int round = 0; round < 100; ++round) {
    std::uint64_t mask[8], back[8] = {};
    for (std::uint64_t& word : mask) word = rng() & rng();
    for (unsigned octant = 0; octant < 8; ++octant) {
      const std::uint64_t bits = codes_of_octant(mask, octant);
      set_octant(bits, octant, back);
      for (unsigned within = 0; within < 64; ++within) {
        unsigned at[3] = {};
        for (unsigned axis = 0; axis < 3; ++axis)
          at[axis] = (within >> axis & 1) + 2 * (within >> (3 + axis) & 1) + 4 * (octant >> axis & 1);
        ASSERT_EQ(bits >> within & 1, mask[at[2]] >> (at[0] + 8 * at[1]) & 1);
        ASSERT_EQ(voxel_of_code(octant << 6 | within), at[0] + 8 * at[1] + 64 * at[2]);
      }
    }
    ASSERT_TRUE(std::equal(mask, mask + 8, back));
  }
}

made::ShardShape random_shape(std::mt19937_64& rng) {
  made::ShardShape shape;
  shape.lods = 1 + int(rng() % 5);
  shape.normals = rng() % 3 != 0;
  shape.max_children = 1 + int(rng() % 8);
  shape.alike = rng() % 2 != 0;
  shape.directional_coverage = rng() % 3 != 0;
  shape.nested = rng() % 4 != 0;
  return shape;
}

TEST(PredictedLevel, ReadsTheVoxelsThatWereWrittenWhollyAndInParts) {
  const test::RandomSeed seed;
  std::mt19937_64 rng(seed);
  const made::TempFolder folder;
  for (int round = 0; round < 60; ++round) {
    const Shard shard = made::random_shard(rng, random_shape(rng));
    write_shard(folder / "s.h5", shard, {callers_thread(), rng() % 3 == 0 ? Codec::lz4 : Codec::deflate});
    ASSERT_EQ(made::difference(shard, read_shard(folder / "s.h5")), "") << "round " << round;
    const ShardPages pages(folder / "s.h5");
    for (std::size_t lod = 0; lod < shard.levels.size(); ++lod) {
      const BrickLevel& level = shard.levels[lod];
      if (level.mask.empty()) continue;
      const std::size_t first = rng() % (level.mask.size() / 8);
      const BrickBlock block = pages.level(int(lod), first, 1);
      const auto begin = std::ptrdiff_t(level.first[first]), end = std::ptrdiff_t(level.first[first + 1]);
      const auto is_part = [&](const auto& part, const auto& whole, std::ptrdiff_t width) {
        return std::equal(part.begin(), part.end(), whole.begin() + (whole.empty() ? 0 : width * begin),
                          whole.begin() + (whole.empty() ? 0 : width * end));
      };
      EXPECT_TRUE(is_part(block.rgba, level.rgba, 4)) << "round " << round << ", lod " << lod;
      EXPECT_TRUE(is_part(block.normal, level.normal, 2)) << "round " << round << ", lod " << lod;
      EXPECT_TRUE(is_part(block.directional_coverage, level.directional_coverage, 4)) << "round " << round;
    }
  }
}

/// A voxel whose plane is complete may have coverages, since `--max-error` changes them; all voxels then store them.
TEST(PredictedLevel, KeepsCoveragesOfVoxelsWithCompletePlanes) {
  const made::TempFolder folder;
  Shard shard = made::small_shard_with_planes();
  shard.levels[1].directional_coverage = {255, 1, 128, 0x1a, 0, 2, 0, 0x3f};
  shard = made::with_content_hash(std::move(shard));
  write_shard(folder / "s.h5", shard, {});
  EXPECT_EQ(made::difference(shard, read_shard(folder / "s.h5")), "");
}

/// Returns a shard whose levels have several rows in `first`.
Shard nested_shard(std::mt19937_64& rng) {
  made::ShardShape shape;
  shape.lods = 6;
  shape.nested = true;
  Shard shard;
  do shard = made::random_shard(rng, shape);
  while (shard.levels[0].mask.size() < 8 * 130);
  return shard;
}

/// Returns the message of reading a shard after a change, wholly or in parts.
std::string message_of(const std::filesystem::path& path, const Shard& shard,
                       const std::function<void(PackedByHand&)>& change, bool in_parts) {
  PackedByHand packed(shard, PackedByHand::As::raw, Codec::deflate);
  change(packed);
  write_packed_shard(path, packed.packed, {});
  try {
    if (!in_parts) read_shard(path);
    const ShardPages pages(path);
    for (int lod = 0; in_parts && lod < int(shard.levels.size()); ++lod)
      for (std::uint64_t b = 0; b < pages.bricks(lod); b += 32) pages.level(lod, b, 32);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

std::uint64_t& start_of(RowBytes& bytes, std::size_t row, std::size_t column) {
  return *reinterpret_cast<std::uint64_t*>(&bytes[24 * row + 8 * column]);
}

TEST(PredictedLevel, IsRefusedWhereItsColumnsContradictEachOther) {
  const test::RandomSeed seed;
  std::mt19937_64 rng(seed);
  const made::TempFolder folder;
  const Shard shard = nested_shard(rng);
  const auto in_first = [](std::size_t row, std::size_t column, std::uint64_t added) {
    return [=](PackedByHand& p) {
      p.edit(0, LevelColumn::first, [=](RowBytes& b) { start_of(b, row, column) += added; });
    };
  };
  const auto longer = [](int lod, LevelColumn column) {
    return [=](PackedByHand& p) {
      p.edit(lod, column, [=](RowBytes& b) { b.resize(b.size() + row_of(column).bytes, 1); });
    };
  };
  const std::vector<std::pair<const char*, std::function<void(PackedByHand&)>>> cases = {
      {"first: row 0: the number of bricks differs", longer(0, LevelColumn::first)},
      {"first: row 0: does not begin at 0", in_first(0, 0, 1)},
      {"first: row 0: does not begin at 0", in_first(0, 1, 1)},
      {"does not count the rows of the bricks", in_first(1, 0, 1)},
      {"does not count the rows of the bricks", in_first(1, 1, 1)},
      {"does not count the rows of the bricks", in_first(1, 0, std::uint64_t(1) << 60)},
      {"does not count the rows of the bricks", in_first(1, 1, ~std::uint64_t(0))},
      {"/lod_0/children: row 0: does not match first", longer(0, LevelColumn::children)},
      {"/lod_0/rgb: row 0: does not match first", longer(0, LevelColumn::rgb)},
      {"/lod_0/alpha: row 0: does not match first", longer(0, LevelColumn::alpha)},
      {"/lod_0/normal: row 0: does not match first", longer(0, LevelColumn::normal)},
      {"/lod_0/plane: row 0: does not match first", longer(0, LevelColumn::plane)},
      {"/lod_1/facing: row 0: does not match first", longer(1, LevelColumn::facing)},
      {"",
       [](PackedByHand& p) {
         p.edit(0, LevelColumn::children, [](RowBytes& b) { b[b.size() / 2] = b[b.size() / 2] == 255 ? 0 : 255; });
       }},
      {"a brick has no voxels",
       [](PackedByHand& p) {
         p.edit(1, LevelColumn::children, [](RowBytes& b) { std::fill(b.begin(), b.end(), 0); });
       }},
      {"a voxel without coverage",
       [](PackedByHand& p) { p.edit(1, LevelColumn::alpha, [](RowBytes& b) { b[b.size() / 2] = 0; }); }},
      {"plane is neither",
       [](PackedByHand& p) { p.edit(0, LevelColumn::plane, [](RowBytes& b) { b[b.size() / 2] = 0x43; }); }},
  };
  for (const bool in_parts : {false, true}) {
    EXPECT_EQ(message_of(
                  folder / "s.h5", shard, [](PackedByHand&) {}, in_parts),
              "");
    for (const auto& [rule, change] : cases) {
      const std::string message = message_of(folder / "s.h5", shard, change, in_parts);
      EXPECT_NE(message, "") << rule;
      EXPECT_NE(message.find(rule), std::string::npos) << rule << " in " << message;
    }
  }
}

/// Edits copy rows of stored columns without decoding them.
TEST(BaseShard, IsRefusedIfAColumnHasAnotherNumberOfRowsThanVoxels) {
  const test::RandomSeed seed;
  std::mt19937_64 rng(seed);
  const made::TempFolder folder;
  const Shard shard = nested_shard(rng);
  for (const LevelColumn column : {LevelColumn::rgb, LevelColumn::alpha, LevelColumn::normal, LevelColumn::plane}) {
    PackedByHand packed(shard, PackedByHand::As::raw, Codec::deflate);
    packed.edit(0, column, [&](RowBytes& b) { b.resize(b.size() + row_of(column).bytes, 1); });
    write_packed_shard(folder / "s.h5", packed.packed, {});
    try {
      const BaseShard base(folder / "s.h5", callers_thread());
      ADD_FAILURE() << level_column(0, column).name << " is accepted";
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find(level_column(0, column).name + ": does not match first"),
                std::string::npos)
          << error.what();
    }
  }
}

/// A source that records the names of the columns that are opened.
class RecordedColumns : public ColumnSource {
 public:
  explicit RecordedColumns(const ColumnSource& source) : source_(source) {}
  const std::filesystem::path& path() const override { return source_.path(); }
  bool has(const Hdf5Column& column) const override { return source_.has(column); }
  std::unique_ptr<StoredRows> open(const Hdf5Column& column) const override {
    opened.push_back(column.name);
    return source_.open(column);
  }
  mutable std::vector<std::string> opened;

 private:
  const ColumnSource& source_;
};

TEST(PredictedLevel, OpensEachColumnOnceAtItsFirstUse) {
  const test::RandomSeed seed;
  std::mt19937_64 rng(seed);
  const Shard shard = nested_shard(rng);
  const int lod = int(shard.levels.size()) - 1;
  const std::uint64_t bricks = shard.levels.back().mask.size() / 8;
  const PackedByHand packed(shard, PackedByHand::As::raw, Codec::deflate);
  const PackedColumns columns(packed.packed);
  const RecordedColumns source(columns);
  const PredictedLevel level(source, shard.header, lod, bricks);
  std::vector<std::string> expected;
  const auto expect_also = [&](std::initializer_list<LevelColumn> opened) {
    for (const LevelColumn column : opened) expected.push_back(level_column(lod, column).name);
    std::ranges::sort(expected);
    std::ranges::sort(source.opened);
    EXPECT_EQ(source.opened, expected);
  };
  expect_also({LevelColumn::first});
  const std::vector<BrickParent> parents(bricks);
  level.read(0, parents, {}, PredictedLevel::Values::masks);
  expect_also({LevelColumn::children});
  level.read(0, parents, {}, PredictedLevel::Values::predictions);
  expect_also({LevelColumn::rgb, LevelColumn::normal});
  level.read(0, parents, {}, PredictedLevel::Values::all);
  expect_also({LevelColumn::alpha, LevelColumn::facing, LevelColumn::plane});
  level.read(0, parents, {}, PredictedLevel::Values::all);
  expect_also({});
}

/// Changes bytes at random; all checksums are correct.
TEST(PredictedLevel, WithRandomBytesIsRefusedOrHasVoxels) {
  const test::RandomSeed seed;
  std::mt19937_64 rng(seed);
  const made::TempFolder folder;
  const Shard shard = nested_shard(rng);
  int refused = 0;
  for (int round = 0; round < 300; ++round) {
    const auto change = [&](PackedByHand& packed) {
      for (std::uint64_t changes = 1 + rng() % 3; changes > 0; --changes) {
        const std::vector<LevelColumn> columns = level_columns(shard.header, 1);
        const int lod = 1 + int(rng() % 3);
        packed.edit(lod, columns[rng() % columns.size()], [&](RowBytes& bytes) {
          if (rng() % 4 == 0) return bytes.resize(bytes.size() / 24 * 24 * (rng() % 3));
          if (!bytes.empty()) bytes[rng() % bytes.size()] = rng() % 2 == 0 ? std::uint8_t(rng()) : std::uint8_t(0);
        });
      }
    };
    const std::string message = message_of(folder / "s.h5", shard, change, rng() % 2 == 0);
    refused += message.empty() ? 0 : 1;
    EXPECT_EQ(message.find('\n'), std::string::npos) << "round " << round;
  }
  EXPECT_GT(refused, 100);
}

}  // namespace
}  // namespace gigabake
