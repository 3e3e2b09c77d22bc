#include "viewer/pictures/render.h"

#include <algorithm>
#include <chrono>

namespace gigabake {
namespace {

/// Interval at which a wait for pages checks `stop`.
constexpr std::chrono::milliseconds stop_check_interval{10};

/// The maximum number of intervals before rays are cast again, although pages are still being read. More pages per pass
/// save time, because a pass costs the same for one page as for many.
constexpr int max_page_checks = 5;

/// Waits for the pages that serve() requested. Returns false if `stop` cancelled the wait.
bool wait_for_served_pages(SceneStream& stream, const SceneStream::Served& served, const kernels::StopAsked& stop) {
  for (int page_checks = 1; !stream.settle(stop_check_interval); ++page_checks) {
    if (stop && stop()) return false;
    if (page_checks >= max_page_checks && (served.uploads != 0 || stream.has_loaded_pages())) break;
  }
  return true;
}

/// Casts the rays of `count` pixels until each ray is finished, and uploads the data that they miss. If the pools
/// cannot hold the working set, processes fewer pixels at a time. `cast` casts one pass over pixels [begin, end), like
/// Caster::cast(). Returns false if `stop` cancelled the rays.
template <class Cast>
bool finish_rays(SceneStream& stream, const Vec3d& eye, std::size_t count, const kernels::StopAsked& stop,
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
        stream.serve(stream.caster().requested(), eye, stop, {stream.caster().pass(), false});
    if (served.evicted_used && many > 1) many /= 2;
    if (!wait_for_served_pages(stream, served, stop)) return false;
    stream.begin_pass();
  }
  return true;
}

/// Casts the tile's primary rays, then second rays for pixels between two levels, then shadow rays. Returns false if
/// `stop` cancelled the rays.
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
  caster.reuse_shadow_samples();
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

}  // namespace

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
