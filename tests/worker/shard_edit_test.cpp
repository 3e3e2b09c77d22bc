// Edits of a stored shard: the same file as a bake with all edits, whatever the cell, the filter and the channels.
#include "worker/edit/shard_edit.h"

#include <bit>
#include <filesystem>
#include <gtest/gtest.h>
#include <random>
#include <unistd.h>

#include "core/octree/morton.h"
#include "format/system/read_file.h"
#include "kernels/cpu/bake_cell.h"
#include "tests/random_seed.h"
#include "worker/pipeline/shard_from_volume.h"

namespace gigabake {
namespace {

using kernels::Level;

/// A random cell: a wavy surface with holes, and solid blocks of one value, which become constant nodes.
class RandomCell {
 public:
  explicit RandomCell(std::mt19937& random) : random_(random) {
    parameters_.frame = {1, {}};
    parameters_.window_voxels = 8u << below(5);
    for (std::size_t c = 0; c < 3; ++c) parameters_.window_min[c] = std::int64_t(1024) * (below(5) - 2);
    parameters_.mip = std::array{MipFilter::coverage, MipFilter::box, MipFilter::thesis}[std::size_t(below(3))];
    parameters_.normals = below(4) != 0;
    parameters_.directional_coverage = parameters_.mip == MipFilter::coverage && below(4) != 0;
    parameters_.classes = parameters_.mip != MipFilter::thesis && below(2) == 0;
    blocks_ = below(3);
    waves_ = below(4) != 0;
  }

  const kernels::CellParameters& parameters() const { return parameters_; }

  Level finest() {
    Level level;
    level.first = {0};
    const std::uint32_t edge = parameters_.window_voxels / brick_edge;
    for (std::uint64_t key = 0; key < std::uint64_t(edge) * edge * edge; ++key) add_brick(key, level);
    return level;
  }

  Edit edit() {
    Edit out;
    out.type = std::array{EditType::carve, EditType::fill, EditType::paint}[std::size_t(below(3))];
    out.rgb = {std::uint8_t(below(3)), 7, std::uint8_t(below(256))};
    if (out.type == EditType::paint && below(2) == 0) out.alpha = std::uint8_t(1 + below(255));
    if (parameters_.classes && out.type != EditType::carve && below(2) == 0) out.voxel_class = VoxelClass(below(4));
    const int n = int(parameters_.window_voxels);
    std::array<double, 3> at{};
    for (std::size_t c = 0; c < 3; ++c) at[c] = double(parameters_.window_min[c] + below(n)) + 0.25 * below(4);
    const int size = 1 + below(below(3) == 0 ? n + 8 : 12);
    if (below(2) == 0)
      out.shape = SphereShape{at, double(size)};
    else
      out.shape = BoxShape{at, {at[0] + size, at[1] + 1 + below(size), at[2] + size}};
    return out;
  }

  int below(int end) { return std::uniform_int_distribution<int>(0, end - 1)(random_); }

 private:
  bool is_solid(std::uint64_t key) const {
    const BrickCoordinate at = demorton(key);
    return blocks_ != 0 && at.x / 2 % 2 == 0 && at.y / std::uint32_t(blocks_) % 2 == 0;
  }

  void add_brick(std::uint64_t key, Level& level) {
    const std::uint64_t before = level.first.back();
    const bool is_solid_here = is_solid(key);
    std::uint64_t voxels = before;
    for (int z = 0; z < brick_edge; ++z) {
      std::uint64_t word = is_solid_here ? ~std::uint64_t(0) : 0;
      for (int bit = 0; bit < 64 && waves_ && !is_solid_here; ++bit)
        if ((bit % 8 + 2 * (bit / 8) + int(key)) % 8 == z && below(16) != 0) word |= std::uint64_t(1) << bit;
      level.mask.push_back(word);
      for (int v = std::popcount(word); v > 0; --v, ++voxels) add_voxel(is_solid_here, level);
    }
    if (voxels == before) return level.mask.resize(level.mask.size() - brick_edge);
    level.key.push_back(key);
    level.first.push_back(voxels);
  }

  void add_voxel(bool is_constant, Level& level) {
    const auto byte = [&](int end) { return std::uint8_t(is_constant ? end - 1 : below(end)); };
    const std::uint8_t alpha = is_constant || below(2) == 0 ? std::uint8_t(255) : std::uint8_t(1 + below(255));
    level.rgba.insert(level.rgba.end(), {byte(200), byte(9), byte(256), alpha});
    if (parameters_.normals) level.normal.insert(level.normal.end(), {std::int8_t(byte(60)), std::int8_t(byte(60))});
    if (kernels::has_finest_planes(parameters_))
      level.directional_coverage.insert(level.directional_coverage.end(),
                                        {0, 0, 0, std::uint8_t(alpha == 255 && !is_constant ? 35 : 0)});
    if (parameters_.classes) level.voxel_class.push_back(VoxelClass(is_constant ? 65535 : below(3)));
  }

  std::mt19937& random_;
  kernels::CellParameters parameters_;
  int blocks_ = 0;
  bool waves_ = true;
};

class ShardEdit : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::temp_directory_path() / ("gigabake_shard_edit_" + std::to_string(::getpid()));
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  static ShardHeader header_of(const kernels::CellParameters& p) {
    ShardHeader h;
    h.generator = "test";
    h.cell = "c_0_0_0";
    h.lattice_min = p.window_min;
    h.cell_voxels = p.window_voxels;
    h.voxel_size_m = 1;
    h.has_normals = p.normals;
    h.has_directional_coverage = p.directional_coverage;
    h.has_classes = p.classes;
    return h;
  }

  /// Writes the shard of the voxels after edits; false if no voxel is left.
  bool write_baked(Level finest, const EditsInScene* edits, const kernels::CellParameters& p, const char* name) {
    if (edits != nullptr) {
      const std::uint64_t edge = p.window_voxels / brick_edge;
      CellEdits(*edits, p, pool_).functions().apply(finest, 0, edge * edge * edge);
    }
    if (finest.key.empty()) return false;
    std::vector<kernels::Level> voxelized;
    voxelized.push_back(std::move(finest));
    write_shard(folder_ / name, shard_from_volume(kernels::volume_of(std::move(voxelized), p, pool_), header_of(p)),
                {pool_, Codec::deflate});
    return true;
  }

  std::filesystem::path folder_;
  ThreadPool pool_{2};
};

TEST_F(ShardEdit, WritesTheFileOfABakeWithAllEdits) {
  const test::RandomSeed seed;
  std::mt19937 random(std::uint32_t(std::uint64_t{seed}));
  constexpr int rounds = 120;
  int compared = 0;
  for (int round = 0; round < rounds; ++round) {
    RandomCell cell(random);
    const kernels::CellParameters& p = cell.parameters();
    const auto list = std::make_shared<EditList>();
    const int edits = 1 + cell.below(4);
    while (int(list->size()) < edits) list->push_back(cell.edit());
    const std::size_t applied = std::size_t(cell.below(edits));
    const auto earlier = std::make_shared<EditList>(list->begin(), list->begin() + std::ptrdiff_t(applied));
    const EditsInScene all(list, std::nullopt, p.frame), first(earlier, std::nullopt, p.frame);
    const std::size_t selecting = CellEdits(first, p, pool_).size();
    const Level finest = cell.finest();
    if (!write_baked(finest, &first, p, "base.h5")) continue;
    const BaseShard base(folder_ / "base.h5", pool_);
    ASSERT_TRUE(base.is_spliceable());
    const auto edited = edited_shard(base, CellEdits(all, p, pool_, selecting), p, pool_);
    ASSERT_TRUE(edited);
    const bool has_voxels = write_baked(finest, &all, p, "baked.h5");
    ASSERT_EQ(!edited->empty(), has_voxels) << round;
    if (!has_voxels) continue;
    const StoredSplice stored =
        write_spliced_shard(folder_ / "edited.h5", edited->shard, base, {pool_, Codec::deflate});
    EXPECT_EQ(read_whole_file(folder_ / "edited.h5"), read_whole_file(folder_ / "baked.h5")) << round;
    const Shard shard = read_shard(folder_ / "edited.h5");
    std::vector<LevelSummary> summaries = summarize_levels(shard, pool_);
    EXPECT_EQ(edited->summaries, summaries) << round;
    EXPECT_LE(stored.copied, stored.stored.file);
    ++compared;
  }
  EXPECT_GT(compared, rounds / 2);
}

}  // namespace
}  // namespace gigabake
