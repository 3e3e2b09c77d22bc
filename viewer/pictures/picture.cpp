#include "viewer/pictures/picture.h"

#include <algorithm>
#include <chrono>
#include <cmath>

namespace gigabake {
namespace {

/// Interval at which a wait for pages checks `stop`.
constexpr std::chrono::milliseconds stop_check_interval{10};

/// Max. number of intervals before rays are cast again although some of their pages are still being read. More pages
/// per pass save time, because a pass costs the same for one page as for many.
constexpr int max_page_checks = 5;

/// Waits for pages. Returns false if `stop` cancelled it.
bool wait_for_served_pages(SceneStream& stream, const SceneStream::Served& served, const kernels::StopAsked& stop) {
  for (int looks = 1; !stream.settle(stop_check_interval); ++looks) {
    if (stop && stop()) return false;
    if (looks >= max_page_checks && (served.uploads != 0 || stream.has_arrivals())) break;
  }
  return true;
}

/// Resumes the rays of `count` pixels until each is finished, and uploads the data that they miss. If the pools cannot
/// hold the working set, processes fewer pixels concurrently. cast: one pass over pixels [begin, end), like
/// Caster::cast(). Returns false if `stop` cancelled it.
template <class Cast>
bool finish_rays(SceneStream& stream, const double eye[3], std::size_t count, const kernels::StopAsked& stop,
                 const Cast& cast) {
  for (std::size_t begin = 0, many = count; begin < count;) {
    const std::size_t end = std::min(begin + many, count);
    const std::size_t waiting = cast(begin, end);
    if (stop && stop()) return false;
    if (waiting == 0) {
      begin = end;
      many *= 2;
      continue;
    }
    const SceneStream::Served served =
        stream.serve(stream.caster().wanted(), eye, stop, {stream.caster().pass(), false});
    if (served.evicted_used && many > 1) many /= 2;
    if (!wait_for_served_pages(stream, served, stop)) return false;
    stream.begin_pass();
  }
  return true;
}

/// Casts the tile's primary rays, then rays between levels, then shadow rays. Returns false if `stop` cancelled it.
bool finish_tile(SceneStream& stream, const kernels::CastCamera& camera, const kernels::CastTile& tile,
                 const RenderSettings& look, const kernels::StopAsked& stop) {
  kernels::Caster& caster = stream.caster();
  const std::size_t pixels = std::size_t(tile.width) * std::size_t(tile.height);
  caster.start(camera, tile);
  const auto cast = [&](std::size_t begin, std::size_t end) { return caster.cast(begin, end, true, stop); };
  if (!finish_rays(stream, camera.eye, pixels, stop, cast)) return false;
  if (look.blends_levels) {
    caster.start_blend();
    const auto blend = [&](std::size_t begin, std::size_t end) { return caster.cast_blend(begin, end, true, stop); };
    if (!finish_rays(stream, camera.eye, pixels, stop, blend)) return false;
  }
  if (!look.lighting) return true;
  caster.start_light(*look.lighting, look.shader);
  const auto cast_light = [&](std::size_t begin, std::size_t end) { return caster.cast_light(begin, end, true, stop); };
  if (!finish_rays(stream, camera.eye, pixels, stop, cast_light)) return false;
  caster.share_light();
  return finish_rays(stream, camera.eye, pixels, stop, cast_light);
}

/// Copies the tile's rows into the whole image.
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

/// Linear interpolation between two pixels of a row. share: weight of the second pixel, in 1/256.
struct Between {
  std::size_t first, second;
  unsigned share;
};

std::vector<Between> between(int from, int to) {
  std::vector<Between> all;
  for (int i = 0; i < to; ++i) {
    const double at = std::clamp((i + 0.5) * from / to - 0.5, 0.0, double(from - 1));
    const auto first = std::size_t(at);
    all.push_back({first, std::min(first + 1, std::size_t(from - 1)), unsigned(256 * (at - double(first)))});
  }
  return all;
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

Picture enlarged(const Picture& picture, int width, int height, PictureLight light) {
  Picture out = blank_picture(width, height, light);
  const std::vector<Between> columns = between(picture.width, width), rows = between(picture.height, height);
  for (std::size_t y = 0, to = 0; y < rows.size(); ++y)
    for (std::size_t x = 0; x < columns.size(); ++x, ++to) {
      const Between &c = columns[x], &r = rows[y];
      const std::size_t upper = r.first * std::size_t(picture.width), lower = r.second * std::size_t(picture.width);
      const std::uint8_t* corners[4] = {&picture.rgba[4 * (upper + c.first)], &picture.rgba[4 * (upper + c.second)],
                                        &picture.rgba[4 * (lower + c.first)], &picture.rgba[4 * (lower + c.second)]};
      for (std::size_t k = 0; k < 4; ++k) {
        const unsigned above = corners[0][k] * (256 - c.share) + corners[1][k] * c.share;
        const unsigned below = corners[2][k] * (256 - c.share) + corners[3][k] * c.share;
        out.rgba[4 * to + k] = std::uint8_t((above * (256 - r.share) + below * r.share + (1u << 15)) >> 16);
      }
      out.depth[to] = picture.depth[(r.share < 128 ? upper : lower) + (c.share < 128 ? c.first : c.second)];
    }
  return out;
}

std::vector<kernels::CastTile> tiles_of(int width, int height, int edge) {
  std::vector<kernels::CastTile> tiles;
  for (int y = 0; y < height; y += edge)
    for (int x = 0; x < width; x += edge)
      tiles.push_back({x, y, std::min(edge, width - x), std::min(edge, height - y)});
  const auto from_middle = [&](const kernels::CastTile& t) {
    return std::hypot(2.0 * t.x + t.width - width, 2.0 * t.y + t.height - height);
  };
  std::stable_sort(tiles.begin(), tiles.end(),
                   [&](const auto& a, const auto& b) { return from_middle(a) < from_middle(b); });
  return tiles;
}

bool render_tile(SceneStream& stream, const kernels::CastCamera& camera, const kernels::CastTile& tile,
                 const RenderSettings& look, const kernels::StopAsked& stop, Picture& picture) {
  if (!finish_tile(stream, camera, tile, look, stop)) return false;
  Picture part =
      blank_picture(tile.width, tile.height, picture.linear.empty() ? PictureLight::srgb : PictureLight::linear_too);
  stream.caster().resolve(look.background, pixels_of(part));
  put_rows(part.rgba, tile, camera.width, picture.rgba);
  put_rows(part.depth, tile, camera.width, picture.depth);
  put_rows(part.linear, tile, camera.width, picture.linear);
  return true;
}

Picture render(SceneStream& stream, const kernels::CastCamera& camera, const Background& background, PictureLight light,
               const std::optional<kernels::CastLighting>& lighting) {
  return render(stream, camera, RenderSettings{to_cast(background), lighting}, light);
}

Picture render(SceneStream& stream, const kernels::CastCamera& camera, const RenderSettings& look, PictureLight light) {
  Picture picture = blank_picture(camera.width, camera.height, light);
  for (const kernels::CastTile& tile : tiles_of(camera.width, camera.height, stream.tile_edge()))
    render_tile(stream, camera, tile, look, {}, picture);
  return picture;
}

}  // namespace gigabake
