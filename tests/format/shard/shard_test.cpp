#include "format/shard/shard.h"

#include <cmath>
#include <fstream>
#include <functional>
#include <gtest/gtest.h>

#include "broken_shards.h"
#include "core/base/error.h"
#include "format/shard/shard_reader.h"
#include "made_shard.h"
#include "tests/random_seed.h"

namespace gigabake {
namespace {

using made::TempFolder;

TEST(Shard, ComesBackAsItWasWritten) {
  const test::RandomSeed seed;
  std::mt19937_64 rng(seed);
  const TempFolder folder;
  for (int round = 0; round < 24; ++round) {
    const Shard shard = made::random_shard(rng, {1 + round % 4, round % 3 != 0, 6, round % 5 < 3});
    const std::uint64_t bytes =
        write_shard(folder / "s.h5", shard, {ThreadPool(1 + round % 3), Codec(round / 2 % 2)}).file;
    EXPECT_EQ(bytes, std::filesystem::file_size(folder / "s.h5"));
    EXPECT_EQ(made::difference(shard, read_shard(folder / "s.h5")), "") << "round " << round;
  }
}

TEST(Shard, RefusesLevelsWhoseArraysDoNotMatch) {
  const TempFolder folder;
  const std::vector<std::function<void(BrickLevel&)>> changes = {
      [](BrickLevel& l) { l.mask[0] = 1; },
      [](BrickLevel& l) { l.mask.pop_back(); },
      [](BrickLevel& l) { l.first[1] = std::uint64_t(1) << 60; },
      [](BrickLevel& l) {
        l.first = {1, 4};
      },
      [](BrickLevel& l) {
        l.first = {0, 3, 3};
      },
      [](BrickLevel& l) { l.rgba.resize(16, 1), l.normal.resize(8); },
      [](BrickLevel& l) { l.normal.resize(4); },
      [](BrickLevel& l) { l.directional_coverage.pop_back(); },
  };
  for (std::size_t c = 0; c < changes.size(); ++c) {
    Shard shard = made::small_shard_with_planes();
    changes[c](shard.levels[0]);
    EXPECT_THROW(write_shard(folder / "s.h5", shard, {}), InputError) << "change " << c;
    EXPECT_FALSE(std::filesystem::exists(folder / "s.h5"));
  }
}

TEST(Shard, IsTheSameFileHoweverManyThreadsCompressIt) {
  const test::RandomSeed seed;
  std::mt19937_64 rng(seed);
  const TempFolder folder;
  const Shard shard = made::random_shard(rng, {5, true, 5});
  const auto written = [&](int threads, Codec codec) {
    write_shard(folder / "s.h5", shard, {ThreadPool(threads), codec});
    std::ifstream file(folder / "s.h5", std::ios::binary);
    return std::string(std::istreambuf_iterator<char>(file), {});
  };
  EXPECT_EQ(written(1, Codec::lz4), written(3, Codec::lz4));
  EXPECT_EQ(written(1, Codec::deflate), written(3, Codec::deflate));
}

TEST(Shard, ComesBackWhereColumnsHaveManyChunks) {
  const test::RandomSeed seed;
  std::mt19937_64 rng(seed);
  const TempFolder folder;
  Shard shard;
  do shard = made::random_shard(rng, {8, true, 8});
  while (shard.levels[0].rgba.size() < std::size_t(1) << 20);
  write_shard(folder / "s.h5", shard, {ThreadPool(2)});
  EXPECT_EQ(made::difference(shard, read_shard(folder / "s.h5")), "");
}

TEST(Shard, GivesItsPartsOneByOne) {
  std::mt19937_64 rng(1);
  const TempFolder folder;
  const Shard shard = made::random_shard(rng, {3, true, 4});
  write_shard(folder / "s.h5", shard, {});
  Shard parts{read_shard_header(folder / "s.h5"), read_shard_nodes(folder / "s.h5"), {}};
  for (int lod = 0; lod < 3; ++lod) parts.levels.push_back(read_shard_level(folder / "s.h5", lod));
  EXPECT_EQ(made::difference(shard, parts), "");
  EXPECT_THROW(read_shard_level(folder / "s.h5", 3), InputError);
  EXPECT_THROW(read_shard_level(folder / "s.h5", -1), InputError);
}

TEST(Shard, WithOneLeafConstantRootHasEmptyLevels) {
  const TempFolder folder;
  const Shard shard = made::constant_shard();
  write_shard(folder / "s.h5", shard, {});
  EXPECT_EQ(made::difference(shard, read_shard(folder / "s.h5")), "");
}

TEST(Shard, SaysHowManyBytesEachLevelTakes) {
  std::mt19937_64 rng(2);
  const TempFolder folder;
  const Shard shard = made::random_shard(rng, {3, true, 6});
  const StoredShard stored = write_shard(folder / "s.h5", shard, {});
  const ShardReader reader(folder / "s.h5");
  std::uint64_t sum = reader.node_bytes();
  for (int lod = 0; lod < 3; ++lod) {
    sum += reader.level_bytes(lod);
    EXPECT_EQ(stored.levels[std::size_t(lod)], reader.level_bytes(lod))
        << "the file need not be read again, lod " << lod;
  }
  EXPECT_GT(reader.level_bytes(0), reader.level_bytes(2));
  EXPECT_LT(sum, stored.file);
  EXPECT_GT(sum, shard.levels[0].rgba.size() / 2) << "random colours do not compress to half";
}

std::string message_of(const std::filesystem::path& path) {
  try {
    read_shard(path);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(Shard, IsNamedWithTheReasonWhereItCannotBeRead) {
  const TempFolder folder;
  EXPECT_NE(message_of(folder / "absent.h5").find("absent.h5: no such file"), std::string::npos);
  std::ofstream(folder / "text.h5") << "not a shard";
  EXPECT_NE(message_of(folder / "text.h5").find("text.h5: H5Fopen failed: "), std::string::npos);
  EXPECT_EQ(message_of(folder / "text.h5").find('\n'), std::string::npos);
}

/// Returns the error message when a shard that breaks a rule is written and read.
std::string told(const std::filesystem::path& path, const std::function<void(Shard&)>& spoil) {
  Shard shard = made::small_shard();
  spoil(shard);
  write_shard(path, shard, {});
  return message_of(path);
}

TEST(Shard, IsRefusedWhereItsPartsDoNotFitEachOther) {
  const TempFolder folder;
  std::vector<made::BrokenShard> cases = made::broken_shards();
  const std::vector<made::BrokenShard> more = {
      {"cell_voxels is not a power", [](Shard& s) { s.header.cell_voxels = 24; }},
      {"voxel_size_m is not positive", [](Shard& s) { s.header.voxel_size_m = NAN; }},
      {"not a multiple of 8", [](Shard& s) { s.header.lattice_min[1] = 4; }},
      {"keys are out of Morton order",
       [](Shard& s) {
         s.nodes.key = {0, 6, 0};
       }},
      {"key is outside the cell", [](Shard& s) { s.nodes.key[2] = 8; }},
      {"is not the child that its parent refers to", [](Shard& s) { s.nodes.child_mask[0] = 0x21; }},
      {"content_hash does not have one entry", [](Shard& s) { s.header.content_hash.pop_back(); }},
  };
  cases.insert(cases.end(), more.begin(), more.end());
  for (const auto& c : cases) EXPECT_NE(told(folder / "s.h5", c.spoil).find(c.rule), std::string::npos) << c.rule;
}

TEST(Shard, LevelIsRefusedByItselfWhereNodesAskForOtherBricks) {
  const TempFolder folder;
  Shard shard = made::small_shard();
  shard.nodes.kind[2] = NodeKind::brick;
  shard.nodes.value[2] = 1;
  write_shard(folder / "s.h5", shard, {});
  EXPECT_NO_THROW(read_shard_nodes(folder / "s.h5"));
  EXPECT_THROW(read_shard_level(folder / "s.h5", 0), InputError);
}

}  // namespace
}  // namespace gigabake
