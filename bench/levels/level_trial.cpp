// gigabake_level_trial SCENE: compares candidates for the content of a coarse voxel. Blocks of 16³ finest voxels are
// rendered from afar, one block per pixel, without any filter, and compared with the finest voxels.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>
#include <limits>
#include <numbers>
#include <vector>

#include "bench/levels/sight.h"
#include "format/system/host_limits.h"
#include "lattice/thread_pool.h"

namespace gigabake::bench {
namespace {

constexpr int reference_edge = 8;  ///< rays of the reference along a pixel's edge

struct Picture {
  int width = 0, height = 0;
  std::vector<double> alpha;
  double at(int x, int y) const { return alpha[std::size_t(x + width * y)]; }
};

/// A parallel view of all blocks.
struct View {
  Vector3 forward, right, up, middle;
  double reach = 0;  ///< max distance of the blocks from the middle
  int edge = 0;      ///< edge of the image, pixels

  SightRay ray(double x, double y) const {
    SightRay r{middle, forward};
    for (std::size_t a = 0; a < 3; ++a)
      r.origin[a] += block_edge * ((x - edge / 2.0) * right[a] + (edge / 2.0 - y) * up[a]) - forward[a] * reach;
    return r;
  }
};

View view_of(const Blocks& blocks, double elevation_degrees, double azimuth_degrees) {
  constexpr double degree = std::numbers::pi / 180;
  const double e = elevation_degrees * degree, z = azimuth_degrees * degree;
  View v;
  v.forward = {std::cos(e) * std::cos(z), std::cos(e) * std::sin(z), -std::sin(e)};
  v.right = {std::sin(z), -std::cos(z), 0};
  v.up = {std::sin(e) * std::cos(z), std::sin(e) * std::sin(z), std::cos(e)};
  constexpr double far = std::numeric_limits<double>::max();
  Vector3 low{far, far, far}, high{-far, -far, -far};
  for (const auto& [index, block] : blocks)
    for (std::size_t a = 0; a < 3; ++a) {
      low[a] = std::min(low[a], double(index[a]) * block_edge);
      high[a] = std::max(high[a], double(index[a] + 1) * block_edge);
    }
  double squares = 0;
  for (std::size_t a = 0; a < 3; ++a) {
    // Shifts the view so that no candidate's voxels are aligned with the pixels.
    v.middle[a] = (low[a] + high[a]) / 2 + 0.37 * block_edge * double(a + 1);
    squares += (high[a] - low[a]) * (high[a] - low[a]) / 4;
  }
  v.reach = std::sqrt(squares) + 2 * block_edge;
  v.edge = int(2 * v.reach / block_edge);
  return v;
}

template <class Alpha>
Picture draw(const ThreadPool& pool, const View& view, int rays, const Alpha& alpha) {
  const auto edge = std::size_t(view.edge);
  Picture p{view.edge, view.edge, std::vector<double>(edge * edge)};
  pool.parallel_for(p.alpha.size(), edge, [&](std::size_t begin, std::size_t end, int) {
    for (std::size_t pixel = begin; pixel < end; ++pixel) {
      const std::size_t row = pixel / edge;
      const auto x = double(pixel % edge), y = double(row);
      double sum = 0;
      for (int j = 0; j < rays; ++j)
        for (int i = 0; i < rays; ++i) sum += alpha(view.ray(x + (i + 0.5) / rays, y + (j + 0.5) / rays));
      p.alpha[pixel] = sum / (rays * rays);
    }
  });
  return p;
}

/// Returns true if the reference is opaque at all pixels around this one.
bool is_inner(const Picture& reference, int x, int y) {
  for (int v = y - 2; v <= y + 2; ++v)
    for (int u = x - 2; u <= x + 2; ++u)
      if (u < 0 || v < 0 || u >= reference.width || v >= reference.height || reference.at(u, v) < 1) return false;
  return true;
}

void report(const NamedCandidate& candidate, double elevation, const Picture& reference, const Picture& seen) {
  double squares = 0, sum = 0, least = 1;
  int count = 0, inner = 0, leaks = 0, holes = 0;
  for (int y = 0; y < seen.height; ++y)
    for (int x = 0; x < seen.width; ++x) {
      const double alpha = seen.at(x, y), off = alpha - reference.at(x, y);
      if (alpha == 0 && reference.at(x, y) == 0) continue;
      ++count;
      squares += off * off;
      sum += off;
      if (!is_inner(reference, x, y)) continue;
      ++inner;
      leaks += alpha < 0.99;
      holes += alpha < 0.9;
      least = std::min(least, alpha);
    }
  std::printf("| %s | %d | %g | %.3f | %+.3f | %.2f %% | %.2f %% | %.2f |\n", candidate.name.c_str(), candidate.bytes,
              elevation, std::sqrt(squares / count), sum / count, inner == 0 ? 0 : 100.0 * leaks / inner,
              inner == 0 ? 0 : 100.0 * holes / inner, least);
}

void compare(const std::string& scene, const std::vector<double>& elevations, double azimuth) {
  const ThreadPool pool(host_limits().cores());
  const Blocks blocks = read_blocks(scene);
  double coherent = 0;
  for (const auto& [index, block] : blocks) coherent += block.coherence;
  std::printf("%zu blocks, %.0f %% of them on one sheet\n\n", blocks.size(), 100 * coherent / double(blocks.size()));
  std::printf("| candidate | bytes | elevation | RMS of alpha | bias | inner < .99 | < .9 | least |\n");
  std::printf("| --- | --- | --- | --- | --- | --- | --- | --- |\n");
  for (const double elevation : elevations) {
    const View view = view_of(blocks, elevation, azimuth);
    const double length = 2 * view.reach;
    const Picture reference =
        draw(pool, view, reference_edge, [&](const SightRay& r) { return meets_voxel(blocks, r, length) ? 1.0 : 0.0; });
    for (const NamedCandidate& candidate : level_candidates())
      report(candidate, elevation, reference,
             draw(pool, view, 1, [&](const SightRay& r) { return candidate.alpha(blocks, r, length); }));
  }
}

}  // namespace
}  // namespace gigabake::bench

int main(int argc, char** argv) {
  CLI::App app{"Candidates for what a coarse voxel stores, against the finest voxels"};
  std::string scene;
  std::vector<double> elevations{80, 35, 10, 5};
  double azimuth = 37;
  app.add_option("SCENE", scene, "scene.xml of a bake")->required();
  app.add_option("--elevation", elevations, "degrees above the horizon, of each view");
  app.add_option("--azimuth", azimuth, "degrees from +x to +y that the views look along");
  CLI11_PARSE(app, argc, argv);
  try {
    gigabake::bench::compare(scene, elevations, azimuth);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "gigabake_level_trial: %s\n", error.what());
    return 1;
  }
}
