#include "kernels/marching/node_exits.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <random>

#include "kernels/marching/cast_line.h"
#include "kernels/marching/locate.h"

namespace gigabake::kernels {
namespace {

constexpr int exit_lods = 8;

/// Returns a line in a cube of 2^13 voxels; some of its direction's components are zero or tiny.
CastLine random_exit_line(std::mt19937_64& random) {
  std::uniform_real_distribution<double> within(0, 1 << 13), component(-1, 1);
  CastLine line{};
  Vec3d direction;
  double squared = 0;
  do {
    for (int a = 0; a < 3; ++a) {
      const auto kind = random() % 8;
      direction[a] = kind == 0 ? 0 : component(random) * (kind == 1 ? 1e-9 : 1);
    }
    squared = dot(direction, direction);
  } while (squared < 1e-6);
  for (int a = 0; a < 3; ++a) {
    line.origin[a] = within(random);
    set_direction(line, a, direction[a] / std::sqrt(squared));
  }
  line.enter = 0;
  line.leave = 1 << 15;
  line.lod1_distance = 100;
  return line;
}

struct Node {
  Vec3<std::uint64_t> at;

  Node(const FixedPoint& point, int lod) {
    for (int a = 0; a < 3; ++a) at[a] = point.bits[a] >> (fraction_bits + brick_bits + lod);
  }
  bool operator==(const Node&) const = default;
};

/// All samples before the exit step lie in the node. Each of them yields the same exit step. At most two samples of the
/// node lie behind it.
TEST(NodeExits, AreTheSameForAllSamplesOfANode) {
  constexpr unsigned seed = 4711;
  std::mt19937_64 random(seed);
  CastScene scene{};
  scene.lods = exit_lods;
  for (int i = 0; i < 20000; ++i) {
    const CastLine line = random_exit_line(random);
    const int lod = int(random() % exit_lods), node_lod = lod + int(random() % 4), coarser = lod + int(random() % 3);
    const LevelPoints points = level_points(scene, line, lod);
    const auto sample = [&](double step) {
      FixedPoint at = points.at(line, lod, step);
      count_for_level(lod, coarser, at);
      return at;
    };
    const auto exit_at = [&](double step) {
      return exit_step_node(line, points, lod, points.at(line, lod, step), sample(step), node_lod);
    };
    const double start = double(random() % 3000);
    const Node node(sample(start), node_lod);
    const double exit_step = exit_at(start);
    const double last = std::min(exit_step, start + 400);
    for (double step = start; step < last; ++step) {
      ASSERT_EQ(Node(sample(step), node_lod), node) << "seed " << seed << " line " << i << " step " << step;
      ASSERT_EQ(exit_at(step), exit_step) << "seed " << seed << " line " << i << " step " << step;
    }
    if (last < exit_step) continue;
    const double slowest = 4 / (step_length(lod) * fixed_one);  // voxels per step below which rounding hides steps
    const Vec3d& d = line.direction;
    if (std::max({std::abs(d[0]), std::abs(d[1]), std::abs(d[2])}) < slowest) continue;
    ASSERT_NE(Node(sample(std::max(exit_step, start) + 2), node_lod), node) << "seed " << seed << " line " << i;
  }
}

}  // namespace
}  // namespace gigabake::kernels
