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
    if (caster.cast(begin, end, true) == 0) {
      begin = end;
      many *= 2;
      continue;
    }
    const SceneStream::Served served =
        stream.serve(caster.wanted(), camera.eye, std::chrono::steady_clock::time_point::max(), {caster.pass(), false});
    if (served.evicted_used && many > 1) many /= 2;
    if (served.uploads == 0) stream.wait();
    stream.begin_pass();
  }
}

/// The tile's rows into those of the whole picture.
template <class T>
void put_rows(const std::vector<T>& part, const kernels::CastTile& tile, int picture_width, std::vector<T>& whole) {
  if (part.empty()) return;
  const std::size_t per_pixel = part.size() / (std::size_t(tile.width) * std::size_t(tile.height));
  const std::size_t row_size = per_pixel * std::size_t(tile.width);
  for (int row = 0; row < tile.height; ++row) {
    const std::size_t to = std::size_t(tile.y + row) * std::size_t(picture_width) + std::size_t(tile.x);
    std::copy_n(&part[std::size_t(row) * row_size], row_size, &whole[per_pixel * to]);
  }
}

}  // namespace

Picture blank_picture(int width, int height, PictureLight light) {
  Picture picture{width, height, {}};
  const std::size_t pixels = std::size_t(width) * std::size_t(height);
  picture.rgba.resize(4 * pixels);
  picture.depth.resize(pixels);
  if (light == PictureLight::linear_too) picture.linear.resize(4 * pixels);
  return picture;
}

kernels::CastPixels pixels_of(Picture& picture) {
  return {picture.rgba.data(), picture.linear.empty() ? nullptr : picture.linear.data(), picture.depth.data()};
}

Picture render(SceneStream& stream, const kernels::CastCamera& camera, const Background& background,
               PictureLight light) {
  Picture picture = blank_picture(camera.width, camera.height, light);
  for (int y = 0; y < camera.height; y += tile_edge)
    for (int x = 0; x < camera.width; x += tile_edge) {
      const kernels::CastTile tile{x, y, std::min(tile_edge, camera.width - x), std::min(tile_edge, camera.height - y)};
      finish_rays(stream, camera, tile);
      Picture part = blank_picture(tile.width, tile.height, light);
      stream.caster().resolve(to_cast(background), pixels_of(part));
      put_rows(part.rgba, tile, camera.width, picture.rgba);
      put_rows(part.depth, tile, camera.width, picture.depth);
      put_rows(part.linear, tile, camera.width, picture.linear);
    }
  return picture;
}

}  // namespace gigabake
