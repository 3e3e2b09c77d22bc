#include <algorithm>
#include <array>
#include <cmath>
#include <gtest/gtest.h>
#include <random>
#include <vector>

#include "kernels/marching/cast.h"
#include "tests/kernels/marching/one_cell.h"

namespace gigabake::kernels {
namespace {

constexpr int lods = 5, cell_bits = lods + 2;

constexpr int edge_bricks = 1 << (cell_bits - 3);

/// A tree of a cell with bricks at random places. An empty node also states that the voxels next to its upper sides are
/// empty. A node is therefore split if a brick is adjacent to its upper sides.
struct RandomTree : OneCell {
  std::vector<bool> stands;
  std::vector<NodeWord> nodes = std::vector<NodeWord>(8, empty_node);
  std::vector<std::uint32_t> parent_bricks{0}, tile_used, slot_used, requested;

  explicit RandomTree(std::mt19937_64& random) : OneCell(cell_bits, lods) {
    for (int i = 0; i < edge_bricks * edge_bricks * edge_bricks; ++i) stands.push_back(random() % 40 == 0);
    fill(0, lods - 1, {0, 0, 0});
    tile_used.resize(nodes.size() / 8);
    slot_used.resize(1);
    requested.resize(nodes.size());
    scene.nodes = nodes.data();
    scene.parent_bricks = parent_bricks.data();
    scene.feedback = {tile_used.data(), slot_used.data(), requested.data()};
    scene.pass = 1;
  }

 private:
  using Brick = std::array<int, 3>;

  bool stands_in(const Brick& low, const Brick& high) const {
    for (int z = low[2]; z < std::min(high[2], edge_bricks); ++z)
      for (int y = low[1]; y < std::min(high[1], edge_bricks); ++y)
        for (int x = low[0]; x < std::min(high[0], edge_bricks); ++x)
          if (stands[std::size_t(x + edge_bricks * (y + edge_bricks * z))]) return true;
    return false;
  }

  void fill(std::size_t node, int lod, const Brick& at) {
    Brick low, high;
    const int beyond = ((1 << lod) - 1 + 7) / 8;
    for (std::size_t a = 0; a < 3; ++a) {
      low[a] = at[a] << lod;
      high[a] = ((at[a] + 1) << lod) + beyond;
    }
    if (!stands_in(low, high)) return;
    if (lod == 0) {
      nodes[node] = pack_node({not_resident_ref, 0});
      return;
    }
    const auto tile = std::uint32_t(nodes.size() / 8);
    nodes[node] = pack_node({tile, 0});
    parent_bricks.push_back(0);
    nodes.resize(nodes.size() + 8, empty_node);
    for (int child = 0; child < 8; ++child)
      fill(8 * tile + std::size_t(child), lod - 1,
           {2 * at[0] + (child & 1), 2 * at[1] + (child >> 1 & 1), 2 * at[2] + (child >> 2)});
  }
};

CastLine random_tree_line(std::mt19937_64& random) {
  std::uniform_real_distribution<double> place(0, 1 << cell_bits), turn(-1, 1);
  CastLine line;
  double squared = 0, direction[3];
  for (double& d : direction) {
    // Some rays are parallel to an axis, or nearly so. Rounding then decides the distance to a side.
    const auto kind = random() % 8;
    d = kind == 0 ? 0 : kind == 1 ? 1e-9 * turn(random) : turn(random);
    squared += d * d;
  }
  if (squared == 0) squared = direction[0] = 1;
  for (int a = 0; a < 3; ++a) {
    const double whole = std::floor(place(random) / 8) * 8;
    line.origin[a] = random() % 4 == 0 ? whole : place(random);
    set_direction(line, a, direction[a] / std::sqrt(squared));
  }
  line.enter = 0;
  line.leave = 2 << cell_bits;
  line.lod1_distance = 1e6;
  return line;
}

bool is_empty(const RandomTree& tree, const CastLine& line, double step) {
  CellFrame frame;
  CastPath path;
  const LevelPoints points = level_points(tree.scene, line, 0);
  return !is_resident(find_brick(tree.scene, line, points, 0, points.at(line, 0, step), true, frame, path).brick);
}

/// Returns a line along a diagonal of x and y that advances equally along both axes. Its points are within a few
/// 1/65536 voxel of the edges of nodes. Rounding would therefore decide which of two siblings is next.
CastLine random_tree_diagonal(std::mt19937_64& random) {
  CastLine line = random_tree_line(random);
  for (int a = 0; a < 2; ++a) {
    const double off = (double(random() % 9) - 4) / fixed_one;
    line.origin[a] = double(random() % (4u << cell_bits)) / 4 + 0.5 + off;
    set_direction(line, a, random() % 2 == 0 ? 0.5 : -0.5);
  }
  set_direction(line, 2, std::sqrt(0.5));
  return line;
}

struct Leaps {
  std::uint64_t points = 0, count = 0;
};

/// Expects all points of the skipped empty space to be empty. Each point is located again, from the root down.
void expect_empty(const RandomTree& tree, const CastLine& line, Leaps& leaps) {
  const LevelPoints points = level_points(tree.scene, line, 0);
  CellFrame frame;
  CastPath path;
  for (double step = 0; step < 2 << cell_bits;) {
    const SampleLocation place = find_brick(tree.scene, line, points, 0, points.at(line, 0, step), true, frame, path);
    const bool is_brick = is_resident(place.brick);
    ASSERT_EQ(is_brick, !is_empty(tree, line, step)) << "at " << step;
    const double steps = is_brick ? 1 : steps_within(place.exit_distance, 2);
    for (double over = step + 1; over < std::min(step + steps, 4.0 * (2 << cell_bits)); ++over) {
      ASSERT_TRUE(is_empty(tree, line, over)) << "from " << step << " over " << over;
      ++leaps.points;
    }
    leaps.count += steps > 1 ? 1 : 0;
    step += steps;
  }
}

/// Lines of all directions, some of which begin on sides of nodes, skip several empty siblings in one step.
TEST(EmptySpace, IsEmptyAtEachPointThatIsSteppedOver) {
  constexpr std::uint64_t seed = 20261124;
  std::mt19937_64 random(seed);
  Leaps leaps;
  for (int round = 0; round < 60; ++round) {
    const RandomTree tree(random);
    for (int i = 0; i < 200; ++i) {
      SCOPED_TRACE(::testing::Message() << "seed " << seed << ", tree " << round << ", ray " << i);
      expect_empty(tree, i % 2 == 0 ? random_tree_line(random) : random_tree_diagonal(random), leaps);
      if (::testing::Test::HasFatalFailure()) return;
    }
  }
  EXPECT_GT(leaps.points, 8 * leaps.count) << "rays leap over brick after brick";
}

/// Fixed-point coordinates differ from the point by at most 1/65536 voxel plus rounding, also far from the origin.
TEST(EmptySpace, IsFoundWhereThePointLies) {
  constexpr std::uint64_t seed = 20261125;
  std::mt19937_64 random(seed);
  const RandomTree tree(random);
  for (int i = 0; i < 1000; ++i) {
    CastLine line = random_tree_line(random);
    if (i % 2 == 1)
      for (double& o : line.origin) o += double(max_scene_edge);
    for (int lod = 0; lod < lods; ++lod) {
      const double step = double(random() % 400);
      const FixedPoint at = level_points(tree.scene, line, lod).at(line, lod, step);
      for (int a = 0; a < 3; ++a) {
        const double place =
            double(std::int64_t(at.bits[a] - fixed_bias_bits)) / fixed_one + double(tree.scene.corner[a]);
        const double exact = line.origin[a] + line.direction[a] * point_distance(line, lod, step) - step_length(lod);
        ASSERT_NEAR(place, exact, 1.5 / fixed_one) << "seed " << seed << ", ray " << i << ", level " << lod;
      }
    }
  }
}

}  // namespace
}  // namespace gigabake::kernels
