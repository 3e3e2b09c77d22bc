// What a parent has of its children's shards, and what verify says where it has something else.
#include "worker/parent_bake.h"

#include <gtest/gtest.h>
#include <map>
#include <optional>
#include <random>

#include "format/scene/verify.h"
#include "format/shard/brick_walk.h"
#include "format/shard/level_lookup.h"
#include "lattice/error.h"
#include "lattice/memory_limit.h"
#include "lattice/morton.h"
#include "tests/format/shard/made_shard.h"
#include "tests/random_seed.h"
#include "worker/parent_check.h"
#include "worker/shard_from_volume.h"

namespace gigabake {
namespace {

using Corner = std::array<std::int64_t, 3>;

constexpr std::int64_t child_edge = 32;

/// Eight cells of three levels, of any voxels; stacks begin at any voxel of their coarsest level.
std::vector<Shard> random_children(std::mt19937_64& rng) {
  std::vector<Shard> children;
  for (std::int64_t i = 0; i < 8; ++i) {
    const std::int64_t z = 8 * std::int64_t((i & 3) % 3) - 8 + child_edge * (i >> 2);
    Shard shard = made::random_shard(rng, {3, true, 4, i % 2 == 0, true});
    shard.header.lattice_min = {child_edge * (i & 1), child_edge * (i >> 1 & 1), z};
    shard.header.cell_voxels = child_edge;
    shard.header.first_lod = 0;
    children.push_back(made::with_content_hash(std::move(shard)));
  }
  return children;
}

/// The child's voxel that holds a lod-0 voxel, by its key, or none. lookup: what the value may point into.
bool find_in_children(const std::vector<Shard>& children, int lod, const Corner& v, std::optional<LevelLookup>& lookup,
                      VoxelValue& value) {
  for (const Shard& child : children) {
    Corner at;
    bool inside = true;
    for (std::size_t a = 0; a < 3; ++a) {
      at[a] = v[a] - child.header.lattice_min[a];
      inside = inside && at[a] >= 0 && at[a] < child_edge;
    }
    if (!inside) continue;
    lookup.emplace(child.nodes, child.levels[std::size_t(lod)], child.header.lods, lod);
    return lookup->find(std::uint32_t(at[0] >> lod), std::uint32_t(at[1] >> lod), std::uint32_t(at[2] >> lod), value);
  }
  return false;
}

TEST(CopiedLevels, HoldTheVoxelsOfTheChildrenThatLieInTheWindowAndNoOthers) {
  const test::RandomSeed seed;
  std::mt19937_64 rng(seed);
  const made::TempFolder folder;
  const std::vector<Shard> children = random_children(rng);
  const CopyWindow window{{0, 0, 0}, 64, 1, 3, true, true};
  std::vector<ChildLevels> read;
  for (const Shard& child : children) {
    write_shard(folder / "child.h5", child, {});
    read.push_back(read_child_levels(ShardReader(folder / "child.h5"), window.begin, window.end));
  }
  std::vector<const ChildLevels*> borrowed;
  for (const ChildLevels& child : read) borrowed.push_back(&child);
  const std::vector<kernels::Level> joined = joined_levels(borrowed, window, ThreadPool(2));
  ASSERT_EQ(joined.size(), 2u);
  for (const int lod : {1, 2}) {
    const kernels::Level& level = joined[std::size_t(lod - 1)];
    std::size_t found = 0, expected = 0;
    for (std::size_t b = 0; b < level.key.size(); ++b) {
      EXPECT_TRUE(b == 0 || level.key[b - 1] < level.key[b]);
      for_each_voxel(
          level, b, demorton(level.key[b]),
          [&](std::uint32_t x, std::uint32_t y, std::uint32_t z, const std::uint8_t* rgba, const std::int8_t* normal,
              const std::uint8_t* facing) {
            VoxelValue value;
            std::optional<LevelLookup> lookup;
            const Corner v{std::int64_t(x) << lod, std::int64_t(y) << lod, std::int64_t(z) << lod};
            ASSERT_TRUE(find_in_children(children, lod, v, lookup, value));
            EXPECT_TRUE(std::equal(rgba, rgba + 4, value.rgba) && std::equal(normal, normal + 2, value.normal));
            for (std::size_t f = 0; f < facing_bytes; ++f)
              EXPECT_EQ(facing[f], value.facing == nullptr ? 0 : value.facing[f]);
            ++found;
          });
    }
    const std::int64_t step = std::int64_t(1) << lod;
    for (std::int64_t z = 0; z < 64; z += step)
      for (std::int64_t y = 0; y < 64; y += step)
        for (std::int64_t x = 0; x < 64; x += step) {
          VoxelValue value;
          std::optional<LevelLookup> lookup;
          expected += find_in_children(children, lod, {x, y, z}, lookup, value);
        }
    EXPECT_EQ(found, expected) << "level " << lod;
    EXPECT_GT(found, 0u);
  }
  borrowed.push_back(borrowed.front());
  EXPECT_THROW(joined_levels(borrowed, window, ThreadPool(1)), InputError) << "a child twice";
}

/// Of the box filter, which needs no rasters.
ParentSource source_of(const Shard& child) {
  ParentSource source;
  const int top = int(child.header.lods) - 1;
  std::map<std::uint32_t, std::vector<std::uint8_t>> rows;  // by bit
  for_each_voxel_of_level(
      child.nodes, child.levels.back(), top,
      [&](std::uint32_t x, std::uint32_t y, std::uint32_t z, const std::uint8_t* rgba, const std::int8_t* normal) {
        const auto byte = [](auto v) { return std::uint8_t(v); };
        rows[x + 8 * y + 64 * z] = {0,       byte(x), byte(y), byte(z),         rgba[0],
                                    rgba[1], rgba[2], rgba[3], byte(normal[0]), byte(normal[1])};
      });
  for (const auto& [bit, row] : rows) {
    source.place.insert(source.place.end(), row.begin(), row.begin() + 4);
    source.rgba.insert(source.rgba.end(), row.begin() + 4, row.begin() + 8);
    for (const std::size_t n : {8u, 9u}) source.normal.push_back(std::int8_t(row[n]));
  }
  return source;
}

/// Two cells of 32³ and their root, on disk.
class Family : public testing::Test {
 protected:
  Family() {
    for (const std::int64_t x : {0, 32}) {
      std::vector<made::Voxel> voxels;
      for (std::int64_t i = 0; i < 200; ++i)
        voxels.push_back({{x + i % 32, i * 7 % 32, i / 16}, {std::uint8_t(i), 40, std::uint8_t(x), 255}, {3, 5}});
      cells_.push_back(made::shard_of(voxels, {x, 0, 0}, 32));
      cells_.back().header.generator = generator();
      cells_.back().above = source_of(cells_.back());
    }
    parameters_ = {.voxel_size_m = cells_[0].header.voxel_size_m,
                   .lattice_origin_m = cells_[0].header.lattice_origin_m,
                   .cell_voxels = 32,
                   .mip = MipFilter::box};
    parameters_.facing = false;
    write_and_describe();
    job_.name = "p3_0_0_0";
    job_.cell_voxels = 64;
    job_.first_lod = 1;
    job_.copied_lods = 2;
    std::vector<ChildOfParent> children;
    for (const SceneCell& cell : scene_.cells) children.push_back(read_child(ShardReader(folder_ / cell.file), job_));
    ShardHeader header = cells_[0].header;
    header.cell = job_.name, header.lattice_min = job_.lattice_min, header.cell_voxels = job_.cell_voxels;
    header.first_lod = job_.first_lod, header.copied_lods = job_.copied_lods;
    parent_ = shard_from_volume(make_parent(job_, children, parameters_, ThreadPool(1)), header);
    write_and_describe();
  }

  void write_and_describe() {
    std::vector<Shard> shards = cells_;
    if (!parent_.levels.empty()) shards.push_back(parent_);
    scene_ = made::write_scene_of(folder_ / "scene.xml", shards);
    scene_.parameters = to_json(parameters_);
    write_scene(folder_ / "scene.xml", scene_);
  }

  std::vector<std::string> faults() {
    write_and_describe();
    const auto check = [this](const SceneHeader& header, const SceneCell& parent, std::span<const SceneCell> children) {
      EXPECT_EQ(children.size(), 2u);
      return faults_of_parent(folder_ / "", header, parent, children);
    };
    return verify_scene(folder_ / "scene.xml", 2, {}, check).faults;
  }

  const made::TempFolder folder_;
  BakeParameters parameters_;
  std::vector<Shard> cells_;
  CellJob job_;
  Shard parent_;
  SceneDescription scene_;
};

TEST_F(Family, IsWholeAsItIsBaked) {
  EXPECT_EQ(parent_.levels.size(), 3u);
  EXPECT_EQ(faults(), std::vector<std::string>());
}

TEST_F(Family, HasAParentThatIsNamedWhereACopyIsNone) {
  ++parent_.levels[0].rgba[4];
  parent_ = made::with_content_hash(std::move(parent_));
  const std::vector<std::string> named = faults();
  ASSERT_EQ(named.size(), 1u);
  EXPECT_NE(named[0].find("p3_0_0_0.h5: /lod_0: is no copy of its children's level 1"), std::string::npos) << named[0];
}

TEST_F(Family, HasAParentThatIsNamedWhereItsOwnVoxelsAreWrong) {
  parent_.levels[2].rgba[3] ^= 1;
  parent_ = made::with_content_hash(std::move(parent_));
  const std::vector<std::string> named = faults();
  ASSERT_EQ(named.size(), 1u);
  EXPECT_NE(named[0].find("/lod_2: is not what its children make of level 3"), std::string::npos) << named[0];
  parent_.header.generator = "gigabake 0.1.9";
  EXPECT_EQ(faults(), std::vector<std::string>()) << "another version may make another level of the same children";
}

TEST_F(Family, IsReadWithinTheMemoryThatABakeMayTake) {
  const made::TempFolder folder;
  std::filesystem::create_directories(folder / "shards");
  CellJob job = job_;
  for (const Shard& cell : cells_) {
    job.child_files.push_back(shard_file(cell.header.cell, cell.header.fingerprint));
    write_shard(folder / job.child_files.back(), cell, {});
  }
  const std::vector<ChildOfParent> children = read_children(folder / "", job);
  ASSERT_EQ(children.size(), 2u);
  const std::uint64_t bytes = bytes_of(children[0]) + bytes_of(children[1]);
  EXPECT_GT(bytes, 2 * 200u * 4u) << "a colour for each voxel";
  const auto refusal = [&](std::uint64_t limit) -> std::string {
    set_memory_limit(limit);
    try {
      read_children(folder / "", job);
    } catch (const InputError& error) {
      return error.what();
    }
    return "none";
  };
  EXPECT_EQ(refusal(2 * bytes), "none");
  EXPECT_NE(refusal(2 * bytes - 1).find("parent p3_0_0_0"), std::string::npos);
  set_memory_limit(0);
}

TEST_F(Family, HasAParentThatIsNamedWhereAChildChangedBeneathIt) {
  cells_[1].levels[1].rgba[0] ^= 1;
  cells_[1] = made::with_content_hash(std::move(cells_[1]));
  EXPECT_EQ(faults().size(), 1u) << "level 1, of which the parent has a copy";
  cells_[0].above.rgba[0] ^= 64;
  const std::vector<std::string> named = faults();
  ASSERT_EQ(named.size(), 3u) << "its own level, too, and what one above it would be made of";
  EXPECT_NE(named[2].find("/above: "), std::string::npos) << named[2];
}

}  // namespace
}  // namespace gigabake
