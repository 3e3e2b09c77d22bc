#include "viewer/stream/requests/request_answers.h"

#include <algorithm>
#include <gtest/gtest.h>
#include <random>

#include "tests/viewer/voxel_scene.h"

namespace gigabake {
namespace {

constexpr std::int64_t root_edge = 16;

std::optional<Paint> one_layer(std::int64_t, std::int64_t, std::int64_t z) {
  return z == 3 ? std::optional<Paint>(Paint{}) : std::nullopt;
}

/// Requests for the root bricks of `edge` times `edge` cells, and their answers. No page is ever resident.
struct ManyRoots {
  VoxelScene scene{root_edge};
  std::vector<SceneCell> cells;
  CellLayout layout;

  explicit ManyRoots(std::int64_t edge) {
    scene.add_cell(one_layer, {0, 0, 0});
    cells.assign(std::size_t(edge * edge), scene.description().cells.at(0));
    for (std::size_t i = 0; i < cells.size(); ++i)
      cells[i].lattice_min = {root_edge * (std::int64_t(i) % edge), root_edge * (std::int64_t(i) / edge), 0};
    layout = lay_out_cells(cells, "scene.xml");
  }

  /// Returns the requests in the order of their answers, for requests in random order.
  std::vector<std::uint32_t> answered(const Vec3d& eye, bool works_ahead, std::mt19937_64& random) const {
    const ThreadPool pool(2);
    const ShardMap map(cells);
    const Pager pager(scene.pages(), {});
    const VoxelLookup lookup(map, pager);
    const Shading shading(kernels::unlit(), scene.description());
    const PoolAllocator allocator(cells.size(), layout.scene.lods,
                                  {PoolAllocator::min_tiles(cells.size(), layout.scene.lods), 16, 4096});
    PooledPages pooled_pages{{}};
    RequestAnswers answers(layout, shading, allocator, pager, lookup, pooled_pages, pool);
    std::vector<std::uint32_t> requests, order;
    for (std::uint32_t root = 0; root < cells.size(); ++root)
      requests.push_back(2 * root + std::uint32_t(kernels::RequestKind::brick));
    std::ranges::shuffle(requests, random);
    answers.begin_pass(requests, {}, eye);
    if (works_ahead) {  // another pass before this one, of which a batch was begun
      answers.next_batch(works_ahead);
      answers.end_pass();
      answers.forget_pages();
      answers.begin_pass(requests, {}, eye);
    }
    while (answers.has_next())
      for (const RequestAnswer& answer : answers.next_batch(works_ahead)) order.push_back(answer.request);
    return order;
  }

  double squared_distance(std::uint32_t request, const Vec3d& eye) const {
    const Vec3d middle = Vec3d(layout.cells[request / 2].min) + Vec3d::all(root_edge / 2.0);
    return dot(middle - eye, middle - eye);
  }
};

/// A pass answers the most urgent requests, the nearest first, also if there are more requests than a pass answers.
TEST(RequestAnswers, AnswerTheNearestOfManyFirst) {
  constexpr unsigned seed = 11;
  std::mt19937_64 random(seed);
  for (const std::int64_t edge : {30, 140, 212}) {
    SCOPED_TRACE(edge);
    const ManyRoots roots(edge);
    const Vec3d eye{double(root_edge * edge) * 0.3, double(root_edge * edge) * 0.6, 50};
    const std::vector<std::uint32_t> order = roots.answered(eye, edge != 140, random);
    ASSERT_EQ(order.size(), std::min<std::size_t>(roots.cells.size(), 32768));
    std::vector<bool> is_answered(roots.cells.size());
    double max_squared = 0;
    for (const std::uint32_t request : order) {
      EXPECT_FALSE(is_answered[request / 2]);
      is_answered[request / 2] = true;
      const double squared = roots.squared_distance(request, eye);
      ASSERT_GE(squared * (1 + 1.0 / 7), max_squared) << "urgencies are sorted to 1/8 of their value";
      max_squared = std::max(max_squared, squared);
    }
    for (std::uint32_t root = 0; root < roots.cells.size(); ++root) {
      if (is_answered[root]) continue;
      ASSERT_GE(roots.squared_distance(2 * root, eye) * (1 + 1.0 / 7), max_squared);
    }
  }
}

}  // namespace
}  // namespace gigabake
