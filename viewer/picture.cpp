#include "viewer/picture.h"

#include <algorithm>
#include <cmath>

#include "kernels/tables.h"

namespace gigabake {
namespace {

/// Rays wait together for what they miss: enough of them to share a page, few enough to need few.
constexpr int tile_edge = 256;

struct BackgroundColour {
  std::array<float, 3> rgb;  ///< linear, premultiplied
  float alpha;
};

BackgroundColour behind(const Background& background, const kernels::CastLine& line, const kernels::Tables& tables) {
  if (background.sky) return {sky_colour({line.direction[0], line.direction[1], line.direction[2]}), 1};
  BackgroundColour colour{{}, float(background.rgba[3]) / 255};
  for (std::size_t k = 0; k < 3; ++k)
    colour.rgb[k] = float(tables.linear_from_srgb[background.rgba[k]]) / 65535 * colour.alpha;
  return colour;
}

void write_pixel(const kernels::CastRay& ray, const BackgroundColour& back, const kernels::Tables& tables,
                 std::uint8_t out[4]) {
  const float alpha = 1 - ray.transmittance * (1 - back.alpha);
  for (std::size_t k = 0; k < 3; ++k) {
    const float premultiplied = ray.rgb[k] + ray.transmittance * back.rgb[k];
    const float straight = alpha > 0 ? std::min(premultiplied / alpha, 1.0f) : 0;
    out[k] = tables.srgb_from_linear[std::size_t(straight * 65535 + 0.5f)];
  }
  out[3] = std::uint8_t(alpha * 255 + 0.5f);
}

/// Casts the tile's rays until each is finished, loading what they miss in between.
void finish_rays(PageCache& pages, const kernels::CastCamera& camera, const kernels::CastTile& tile,
                 kernels::Span<kernels::CastRay> rays, const kernels::CpuPolicy& policy) {
  kernels::start_rays(pages.scene(), camera, tile, rays, policy);
  for (;;) {
    pages.begin_pass();
    kernels::cast_rays(pages.scene(), camera, tile, rays, policy);
    std::vector<std::uint32_t> missing;
    for (std::size_t i = 0; i < rays.size; ++i)
      if (rays[i].lod >= 0) missing.push_back(rays[i].missing);
    if (missing.empty()) return;
    pages.load(std::move(missing));
  }
}

}  // namespace

Picture render(PageCache& pages, const kernels::CastCamera& camera, const Background& background,
               const kernels::CpuPolicy& policy) {
  const kernels::Tables tables = kernels::TableStore::host().view();
  Picture picture{camera.width, camera.height, {}};
  picture.rgba.resize(std::size_t(4) * std::size_t(camera.width) * std::size_t(camera.height));
  std::vector<kernels::CastRay> rays;
  for (int y = 0; y < camera.height; y += tile_edge)
    for (int x = 0; x < camera.width; x += tile_edge) {
      const kernels::CastTile tile{x, y, std::min(tile_edge, camera.width - x), std::min(tile_edge, camera.height - y)};
      rays.resize(std::size_t(tile.width) * std::size_t(tile.height));
      finish_rays(pages, camera, tile, {rays.data(), rays.size()}, policy);
      for (int row = 0; row < tile.height; ++row)
        for (int column = 0; column < tile.width; ++column) {
          const kernels::CastLine line = kernels::line_of_sight(pages.scene(), camera, x + column, y + row);
          write_pixel(rays[std::size_t(row) * std::size_t(tile.width) + std::size_t(column)],
                      behind(background, line, tables), tables,
                      &picture.rgba[4 * (std::size_t(y + row) * std::size_t(camera.width) + std::size_t(x + column))]);
        }
    }
  return picture;
}

}  // namespace gigabake
