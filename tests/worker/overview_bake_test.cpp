// An overview's content, computed from its children's shards, and the faults that verify reports if it differs.
#include "worker/overview/overview_bake.h"

#include <gtest/gtest.h>
#include <map>
#include <optional>
#include <random>

#include "core/base/error.h"
#include "core/base/memory_limit.h"
#include "core/math/box3.h"
#include "core/octree/morton.h"
#include "format/scene/check/verify.h"
#include "format/shard/levels/brick_walk.h"
#include "format/shard/levels/level_lookup.h"
#include "tests/format/shard/made_shard.h"
#include "tests/random_seed.h"
#include "worker/overview/child_bytes.h"
#include "worker/overview/overview_check.h"
#include "worker/pipeline/shard_from_volume.h"

namespace gigabake {
namespace {

using Corner = Vec3i64;

constexpr std::int64_t child_edge = 32;

/// Returns eight cells of three levels with random voxels; stacks begin at any voxel of their coarsest level.
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

/// Finds the children's voxel of level `lod` that contains the lod-0 voxel v. Returns false if there is none. The found
/// value may point into `lookup`.
bool find_in_children(const std::vector<Shard>& children, int lod, const Corner& v, std::optional<LevelLookup>& lookup,
                      VoxelValue& value) {
  for (const Shard& child : children) {
    if (!Box3i64::cube(child.header.lattice_min, child_edge).contains(v)) continue;
    const Vec3<std::uint32_t> at((v - child.header.lattice_min) >> lod);
    lookup.emplace(child.nodes, child.levels[std::size_t(lod)], child.header.lods, lod);
    return lookup->find(at[0], at[1], at[2], value);
  }
  return false;
}

TEST(CopiedLevels, HoldTheVoxelsOfTheChildrenThatLieInTheWindowAndNoOthers) {
  const test::RandomSeed seed;
  std::mt19937_64 rng(seed);
  const made::TempFolder folder;
  const std::vector<Shard> children = random_children(rng);
  const DuplicatedWindow window{{0, 0, 0}, 64, 1, 3, true, true};
  std::vector<ChildLevels> read;
  for (const Shard& child : children) {
    write_shard(folder / "child.h5", child, {});
    read.push_back(read_child_levels(ShardReader(folder / "child.h5"), window.begin));
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
              const std::uint8_t* directional_coverage) {
            VoxelValue value;
            std::optional<LevelLookup> lookup;
            const Corner v{std::int64_t(x) << lod, std::int64_t(y) << lod, std::int64_t(z) << lod};
            ASSERT_TRUE(find_in_children(children, lod, v, lookup, value));
            EXPECT_TRUE(std::equal(rgba, rgba + 4, value.rgba) && std::equal(normal, normal + 2, value.normal));
            for (std::size_t f = 0; f < directional_coverage_bytes; ++f)
              EXPECT_EQ(directional_coverage[f],
                        value.directional_coverage == nullptr ? 0 : value.directional_coverage[f]);
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

/// Returns a cell of 512³ voxels with a rough surface: nearly all of its nodes are of levels that no overview copies.
Shard large_cell(std::mt19937_64& rng) {
  std::vector<made::Voxel> voxels;
  for (std::int64_t x = 0; x < 512; x += 3)
    for (std::int64_t y = 0; y < 512; y += 3) {
      const std::uint64_t bits = rng();
      voxels.push_back({{x, y, 200 + std::int64_t(bits % 60)},
                        {std::uint8_t(bits >> 8), std::uint8_t(bits >> 16), std::uint8_t(bits >> 24), 255},
                        {std::int8_t(bits >> 32), std::int8_t(bits >> 40)}});
    }
  return made::shard_of(voxels, {}, 512);
}

// 2026-11-25: an overview read the whole node table of each child, 25 ms for a cell of 2048³, serially.
TEST(ReadChild, ReadsOnlyTheRowsThatTheOverviewCopies) {
  const test::RandomSeed seed;
  std::mt19937_64 rng(seed);
  const made::TempFolder folder;
  Shard cell = large_cell(rng);
  cell.above = made::small_above();
  cell.above.raster.clear(), cell.above.patch.clear();
  write_shard(folder / "cell.h5", cell, {});
  CellJob overview;
  overview.cell_voxels = 4096;
  overview.first_lod = 4;
  overview.copied_lods = 3;
  const ShardReader reader(folder / "cell.h5");
  const OverviewChild child = read_child(reader, overview);
  const ColumnReads reads = reader.reads();

  std::size_t copied_nodes = 0, copied_voxels = 0, columns = 5;  // columns of /above
  for (const std::uint8_t lod : cell.nodes.lod) copied_nodes += lod >= 4;
  for (std::size_t lod = 4; lod < cell.levels.size(); ++lod) copied_voxels += cell.levels[lod].rgba.size() / 4;
  ASSERT_EQ(child.copied.coarse.nodes.key.size(), copied_nodes);
  ASSERT_GT(cell.nodes.key.size(), 30 * copied_nodes);
  EXPECT_GE(reads.rows, copied_voxels);
  // Each of the three levels has at most seven columns. The nodes have two columns.
  columns += 3 * level_column_count;
  const std::uint64_t node_rows = 2 * 4096, brick_rows = columns * (copied_nodes + 1);
  EXPECT_LE(reads.rows, node_rows + brick_rows + 5 * copied_voxels + 5 * cell.above.voxels());
  std::uint64_t coarse_bytes = reader.node_bytes();
  for (std::size_t lod = 4; lod < cell.levels.size(); ++lod) coarse_bytes += reader.level_bytes(int(lod));
  EXPECT_LT(reads.bytes, coarse_bytes);
  EXPECT_LT(8 * reads.bytes, std::filesystem::file_size(folder / "cell.h5"));
}

void expect_same(const OverviewChild& a, const OverviewChild& b) {
  EXPECT_EQ(a.source, b.source);
  EXPECT_EQ(a.copied.lattice_min, b.copied.lattice_min);
  EXPECT_EQ(a.copied.first_lod, b.copied.first_lod);
  EXPECT_EQ(a.copied.begin, b.copied.begin);
  const NodeTable &m = a.copied.coarse.nodes, &n = b.copied.coarse.nodes;
  EXPECT_EQ(m.key, n.key);
  EXPECT_EQ(m.lod, n.lod);
  EXPECT_EQ(m.kind, n.kind);
  EXPECT_EQ(m.child_mask, n.child_mask);
  EXPECT_EQ(m.first_child, n.first_child);
  EXPECT_EQ(m.value, n.value);
  EXPECT_EQ(m.normal, n.normal);
  EXPECT_EQ(m.directional_coverage, n.directional_coverage);
  EXPECT_EQ(m.has_finest_planes, n.has_finest_planes);
  ASSERT_EQ(a.copied.coarse.levels.size(), b.copied.coarse.levels.size());
  for (std::size_t l = 0; l < a.copied.coarse.levels.size(); ++l) {
    const BrickLevel &i = a.copied.coarse.levels[l], &j = b.copied.coarse.levels[l];
    EXPECT_EQ(i.mask, j.mask);
    EXPECT_EQ(i.first, j.first);
    EXPECT_EQ(i.rgba, j.rgba);
    EXPECT_EQ(i.normal, j.normal);
    EXPECT_EQ(i.directional_coverage, j.directional_coverage);
  }
}

TEST(ChildOf, AShardInMemoryIsWhatIsReadOfItsFile) {
  const test::RandomSeed seed;
  std::mt19937_64 rng(seed);
  const made::TempFolder folder;
  for (int round = 0; round < 40; ++round) {
    made::ShardShape shape;
    shape.lods = 1 + int(rng() % 4);
    shape.normals = rng() % 2 != 0;
    shape.directional_coverage = rng() % 2 != 0;
    shape.alike = rng() % 2 != 0;
    Shard shard = made::random_shard(rng, shape);
    shard.above.place = {0, 1, 2, 3};
    shard.above.rgba = {4, 5, 6, 7};
    shard.above.normal.assign(shape.normals ? 2 : 0, 1);
    write_shard(folder / "child.h5", shard, {});
    CellJob overview;
    overview.first_lod = shard.header.first_lod + std::uint32_t(rng() % std::uint64_t(shape.lods + 1));
    overview.copied_lods = 1;
    const OverviewChild read = read_child(ShardReader(folder / "child.h5"), overview);
    expect_same(child_of(std::move(shard), overview.first_lod), read);
    expect_same(overview_child_from_bytes(to_bytes(read)), read);
  }
}

TEST(ChildBytes, AreRefusedWhereBytesAreMissingOrTooMany) {
  const test::RandomSeed seed;
  std::mt19937_64 rng(seed);
  std::vector<std::uint8_t> bytes = to_bytes(child_of(made::random_shard(rng, {2, true, 4, false, true}), 0));
  for (std::size_t size = 0; size < bytes.size(); size += 1 + rng() % 5)
    EXPECT_THROW(overview_child_from_bytes(std::span(bytes).first(size)), InputError) << size;
  bytes.push_back(0);
  EXPECT_THROW(overview_child_from_bytes(bytes), InputError);
}

/// Returns the child's downsample state for the box filter, which needs no coverage masks.
DownsampleState source_of(const Shard& child) {
  DownsampleState source;
  const int top = int(child.header.lods) - 1;
  std::map<std::uint32_t, std::vector<std::uint8_t>> rows;  // by number of the voxel in its brick
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

/// A fixture with two cells of 32³ and their root, on disk.
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
    parameters_.directional_coverage = false;
    write_and_describe();
    job_.name = "p3_0_0_0";
    job_.cell_voxels = 64;
    job_.first_lod = 1;
    job_.copied_lods = 2;
    OverviewChildren children;
    for (const SceneCell& cell : scene_.cells)
      children.push_back(std::make_shared<const OverviewChild>(read_child(ShardReader(folder_ / cell.file), job_)));
    ShardHeader header = cells_[0].header;
    header.cell = job_.name, header.lattice_min = job_.lattice_min, header.cell_voxels = job_.cell_voxels;
    header.first_lod = job_.first_lod, header.copied_lods = job_.copied_lods;
    overview_ = shard_from_volume(make_overview(job_, children, parameters_, ThreadPool(1)), header);
    write_and_describe();
  }

  void write_and_describe() {
    std::vector<Shard> shards = cells_;
    if (!overview_.levels.empty()) shards.push_back(overview_);
    scene_ = made::write_scene_of(folder_ / "scene.xml", shards);
    scene_.parameters = to_json(parameters_);
    write_scene(folder_ / "scene.xml", scene_);
  }

  std::vector<std::string> faults() {
    write_and_describe();
    const auto check = [this](const SceneHeader& header, const SceneCell& overview,
                              std::span<const SceneCell> children) {
      EXPECT_EQ(children.size(), 2u);
      return overview_faults(folder_ / "", header, overview, children);
    };
    return verify_scene(folder_ / "scene.xml", 2, {}, check).faults;
  }

  const made::TempFolder folder_;
  BakeParameters parameters_;
  std::vector<Shard> cells_;
  CellJob job_;
  Shard overview_;
  SceneDescription scene_;
};

TEST_F(Family, IsWholeAsItIsBaked) {
  EXPECT_EQ(overview_.levels.size(), 3u);
  EXPECT_EQ(faults(), std::vector<std::string>());
}

TEST_F(Family, HasAnOverviewThatIsNamedWhereACopyIsNone) {
  ++overview_.levels[0].rgba[4];
  overview_ = made::with_content_hash(std::move(overview_));
  const std::vector<std::string> named = faults();
  ASSERT_EQ(named.size(), 1u);
  EXPECT_NE(named[0].find("p3_0_0_0.h5: /lod_0: is not a copy of its children's level 1"), std::string::npos)
      << named[0];
}

TEST_F(Family, HasAnOverviewThatIsNamedWhereItsOwnVoxelsAreWrong) {
  overview_.levels[2].rgba[3] ^= 1;
  overview_ = made::with_content_hash(std::move(overview_));
  const std::vector<std::string> named = faults();
  ASSERT_EQ(named.size(), 1u);
  EXPECT_NE(named[0].find("/lod_2: does not follow from its children for level 3"), std::string::npos) << named[0];
  overview_.header.generator = "gigabake 0.1.9";
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
  const ThreadPool pool(2);
  const auto nothing_in_memory = [](const std::string&) { return std::shared_ptr<const OverviewChild>(); };
  const OverviewChildren children = read_children(folder / "", job, nothing_in_memory, pool);
  ASSERT_EQ(children.size(), 2u);
  const std::uint64_t bytes = bytes_of(*children[0]) + bytes_of(*children[1]);
  EXPECT_GT(bytes, 2 * 200u * 4u) << "a colour for each voxel";
  const auto refusal = [&](std::uint64_t limit) -> std::string {
    set_memory_limit(limit);
    try {
      read_children(folder / "", job, nothing_in_memory, pool);
    } catch (const InputError& error) {
      return error.what();
    }
    return "none";
  };
  EXPECT_EQ(refusal(2 * bytes), "none");
  EXPECT_NE(refusal(2 * bytes - 1).find("parent p3_0_0_0"), std::string::npos);
  set_memory_limit(0);
}

TEST_F(Family, HasAnOverviewThatIsNamedWhereAChildChangedBeneathIt) {
  cells_[1].levels[1].rgba[0] ^= 1;
  cells_[1] = made::with_content_hash(std::move(cells_[1]));
  EXPECT_EQ(faults().size(), 1u) << "level 1, of which the overview has a copy";
  cells_[0].above.rgba[0] ^= 64;
  const std::vector<std::string> named = faults();
  ASSERT_EQ(named.size(), 3u) << "its own level, too, and what one above it would be made of";
  EXPECT_NE(named[2].find("/above: "), std::string::npos) << named[2];
}

}  // namespace
}  // namespace gigabake
