// A scene without files: waves, generated brick by brick when the viewer requests them.
// Prints the number of generated pages, and of pixels with voxels.
#include <atomic>
#include <cmath>
#include <core/octree/parameters.h>
#include <cstdio>
#include <exception>
#include <viewer/pictures/frame_renderer.h>
#include <viewer/pictures/image_files.h>

namespace {

using namespace gigabake;

constexpr int cells_across = 24;

/// Returns cells of one brick each, so that a cell has a single level and a single node.
SceneDescription waves() {
  SceneDescription scene;
  scene.voxel_size_m = 0.5;
  scene.parameters = to_json(BakeParameters{.voxel_size_m = 0.5});
  for (int i = 0; i < cells_across * cells_across; ++i) {
    SceneCell cell;
    cell.name = "wave " + std::to_string(i);
    cell.lattice_min = {brick_edge * (i % cells_across), brick_edge * (i / cells_across), 0};
    cell.cell_voxels = brick_edge;
    cell.lods = 1;
    scene.cells.push_back(cell);
  }
  return scene;
}

BrickBlock wave_brick(int cell) {
  BrickBlock brick;
  brick.first = {0, 0};
  for (int z = 0; z < brick_edge; ++z) {
    std::uint64_t word = 0;
    for (int y = 0; y < brick_edge; ++y)
      for (int x = 0; x < brick_edge; ++x) {
        const int at_x = brick_edge * (cell % cells_across) + x, at_y = brick_edge * (cell / cells_across) + y;
        if (int(3.5 + 3 * std::sin(at_x * 0.15) * std::cos(at_y * 0.11)) != z) continue;
        word |= std::uint64_t(1) << (x + 8 * y);
        for (const int v : {40, 90 + 10 * z, 120 + 15 * z, 255}) brick.rgba.push_back(std::uint8_t(v));
        for (const int v : {0, 0}) brick.normal.push_back(std::int8_t(v));  // straight up
      }
    brick.mask.push_back(word);
  }
  brick.first[1] = std::uint32_t(brick.rgba.size() / 4);
  return brick;
}

}  // namespace

int main(int arguments, char** argument) {
  if (arguments != 2) return 2;
  try {
    std::atomic<int> made{0};
    const PageSource producer = [&](const PageKey& key) {
      ++made;
      Page page;
      if (key.part == PageKey::node_rows)
        page.rows = {NodeRow{}};  // the root: a brick, the first of its level
      else
        page.bricks = wave_brick(int(key.shard));
      return page;
    };
    FrameRenderer renderer(waves(), "waves", producer, {});
    View view;
    view.camera.width = view.camera.height = 96;
    view.background = {false, {0, 0, 0, 0}};
    const Picture picture = renderer.render_complete(view).picture;
    for (const std::string& problem : renderer.problems()) std::fprintf(stderr, "%s\n", problem.c_str());
    write_png(argument[1], picture);
    int pixels = 0;
    for (std::size_t i = 3; i < picture.rgba.size(); i += 4) pixels += picture.rgba[i] > 0 ? 1 : 0;
    std::printf("%d %d\n", made.load(), pixels);
    return renderer.problems().empty() ? 0 : 1;
  } catch (const std::exception& e) {
    std::fprintf(stderr, "%s\n", e.what());
    return 1;
  }
}
