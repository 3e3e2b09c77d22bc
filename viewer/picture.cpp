#include "viewer/picture.h"

#include <algorithm>

namespace gigabake {
namespace {

/// Rays wait together for what they miss: enough of them to share it, few enough to need little.
constexpr int tile_edge = 256;

/// Casts the tile's rays until each is finished, putting in what they miss in between. Where the pools do not hold what
/// they use together, fewer at a time.
void finish_rays(SceneStream& stream, const kernels::CastCamera& camera, const kernels::CastTile& tile) {
  kernels::Caster& caster = stream.caster();
  caster.start(camera, tile);
  const std::size_t rays = std::size_t(tile.width) * std::size_t(tile.height);
  for (std::size_t begin = 0, many = rays; begin < rays;) {
    const std::size_t end = std::min(begin + many, rays);
    if (caster.cast(begin, end) == 0) {
      begin = end;
      many *= 2;
      continue;
    }
    const SceneStream::Served served =
        stream.serve(caster.wanted(), camera.eye, std::chrono::steady_clock::time_point::max(), true);
    if (served.evicted_used && many > 1) many /= 2;
    if (served.uploads == 0) stream.wait();
    stream.begin_pass();
  }
}

}  // namespace

Picture render(SceneStream& stream, const kernels::CastCamera& camera, const Background& background) {
  kernels::CastCamera patient = camera;
  patient.look.waits = true;
  Picture picture{camera.width, camera.height, {}, {}};
  const auto width = std::size_t(camera.width);
  picture.rgba.resize(4 * width * std::size_t(camera.height));
  picture.depth.resize(width * std::size_t(camera.height));
  std::vector<std::uint8_t> rgba;
  std::vector<float> depth;
  for (int y = 0; y < camera.height; y += tile_edge)
    for (int x = 0; x < camera.width; x += tile_edge) {
      const kernels::CastTile tile{x, y, std::min(tile_edge, camera.width - x), std::min(tile_edge, camera.height - y)};
      finish_rays(stream, patient, tile);
      const auto across = std::size_t(tile.width);
      rgba.resize(4 * across * std::size_t(tile.height));
      depth.resize(across * std::size_t(tile.height));
      stream.caster().resolve(to_cast(background), rgba.data(), depth.data());
      for (int row = 0; row < tile.height; ++row) {
        const std::size_t from = std::size_t(row) * across, to = std::size_t(y + row) * width + std::size_t(x);
        std::copy_n(&rgba[4 * from], 4 * across, &picture.rgba[4 * to]);
        std::copy_n(&depth[from], across, &picture.depth[to]);
      }
    }
  return picture;
}

}  // namespace gigabake
