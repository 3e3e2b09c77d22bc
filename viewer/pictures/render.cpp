#include "viewer/pictures/render.h"

#include <algorithm>
#include <chrono>
#include <utility>
#include <vector>

namespace gigabake {
namespace {

/// The rows of a group are a multiple of this number. Smaller groups would need more passes.
constexpr int rows_per_group = 128;

/// Interval at which a wait for pages checks `stop`.
constexpr std::chrono::milliseconds stop_check_interval{10};

/// The maximum number of intervals before rays are cast again, although pages are still being read. More pages per pass
/// save time, because a pass costs the same for one page as for many.
constexpr int max_page_checks = 5;

/// The inverse of the fraction of a group's requests that may still be open when the group is cast again. Fewer passes
/// save work; fewer waits keep all threads busy.
constexpr std::size_t max_open_part = 4;

/// Waits for the pages that serve() requested. Returns false if `stop` cancelled the wait.
bool wait_for_served_pages(SceneStream& stream, const SceneStream::Served& served, const kernels::StopAsked& stop) {
  for (int page_checks = 1; !stream.settle(stop_check_interval); ++page_checks) {
    if (stop && stop()) return false;
    if (page_checks >= max_page_checks && (served.uploads != 0 || stream.has_loaded_pages())) break;
  }
  return !stop || !stop();
}

/// A part of a tile whose rays are cast in one pass, and the data that they missed in their last pass.
struct RayGroup {
  std::size_t begin = 0, end = 0;  ///< pixels of the tile
  std::uint32_t pass = 0;
  std::vector<std::uint32_t> requests = {};
};

/// Splits a large tile into two groups of rows if `alternates` is true.
std::vector<RayGroup> groups_of(const kernels::CastTile& tile, bool alternates) {
  const std::size_t pixels = std::size_t(tile.width) * std::size_t(tile.height);
  if (!alternates || tile.height < 2 * rows_per_group) return {{0, pixels}};
  const std::size_t half = std::size_t(tile.width) * std::size_t(tile.height / 2 / rows_per_group * rows_per_group);
  return {{0, half}, {half, pixels}};
}

/// The state of rays at the end of GroupRays::finish().
enum class RaysState : std::uint8_t {
  finished,
  cancelled,
  too_little_memory,  ///< unfinished, because the pools cannot hold the data of all groups
};

/// Rays of a tile in groups. While one group is cast, the pages that the other groups miss are read.
class GroupRays {
 public:
  GroupRays(SceneStream& stream, const Vec3d& eye, const kernels::StopAsked& stop, PassCounts& counts,
            std::vector<RayGroup> groups)
      : stream_(stream), eye_(eye), stop_(stop), counts_(counts), groups_(std::move(groups)) {}

  /// Casts passes and uploads the data that rays miss, until all rays are finished. `cast` casts one pass over pixels
  /// [begin, end), like Caster::cast().
  template <class Cast>
  RaysState finish(const Cast& cast) {
    for (RaysState state = RaysState::finished; !groups_.empty();) {
      RayGroup& group = groups_[next_];
      const std::size_t waiting = cast(group.begin, group.end);
      if (stop_ && stop_()) return RaysState::cancelled;
      ++counts_.passes;
      group.pass = stream_.caster().pass();
      group.requests = waiting == 0 ? std::vector<std::uint32_t>() : stream_.caster().requested();
      if (waiting == 0)
        groups_.erase(groups_.begin() + std::ptrdiff_t(next_));
      else
        ++next_;
      if (next_ >= groups_.size()) next_ = 0;
      if (!groups_.empty()) state = serve();
      if (state != RaysState::finished) return state;
    }
    return RaysState::finished;
  }

 private:
  /// Answers requests until the next group can progress; RaysState::finished means that it can.
  RaysState serve() {
    for (;; ++counts_.page_waits) {
      // The pages that the previous call requested were read during the latest pass.
      if (served_.misses_pages && !wait_for_served_pages(stream_, served_, stop_)) return RaysState::cancelled;
      stream_.begin_pass();
      served_ = stream_.serve(requests(), eye_, stop_, {first_pass(), false});
      if (served_.evicted_used || served_.is_full) return RaysState::too_little_memory;
      const RayGroup& next = groups_[next_];
      if (!served_.misses_pages || next.pass == 0) return RaysState::finished;
      if (stream_.open_requests(next.requests) <= next.requests.size() / max_open_part) return RaysState::finished;
    }
  }

  /// Returns the requests of all groups, each once.
  std::vector<std::uint32_t> requests() const {
    if (groups_.size() == 1) return groups_[0].requests;
    std::vector<std::uint32_t> all;
    for (const RayGroup& group : groups_) all.insert(all.end(), group.requests.begin(), group.requests.end());
    std::sort(all.begin(), all.end());
    all.erase(std::unique(all.begin(), all.end()), all.end());
    return all;
  }

  /// Returns the earliest of the groups' latest passes. Data that rays used since then is evicted last.
  std::uint32_t first_pass() const {
    std::uint32_t first = stream_.caster().pass();
    for (const RayGroup& group : groups_)
      if (group.pass != 0) first = std::min(first, group.pass);
    return first;
  }

  SceneStream& stream_;
  const Vec3d& eye_;
  const kernels::StopAsked& stop_;
  PassCounts& counts_;
  std::vector<RayGroup> groups_;  ///< groups with unfinished rays
  std::size_t next_ = 0;          ///< the group of the next pass
  SceneStream::Served served_;
};

/// Finishes the rays of one tile, phase by phase: primary rays, second rays, rays to the light.
class TileRays {
 public:
  TileRays(SceneStream& stream, const kernels::CastCamera& camera, const kernels::CastTile& tile,
           const kernels::StopAsked& stop, PassCounts& counts)
      : stream_(stream), camera_(camera), tile_(tile), stop_(stop), counts_(counts) {}

  /// Casts the tile's primary rays, then second rays for pixels between two levels, then shadow rays. Returns false if
  /// `stop` cancelled the rays.
  bool finish(const RenderSettings& look) {
    kernels::Caster& caster = stream_.caster();
    caster.start(camera_, tile_);
    if (!finish_phase([&](std::size_t begin, std::size_t end) { return caster.cast(begin, end, true, stop_); }))
      return false;
    if (look.blends_levels) {
      caster.start_blend();
      if (!finish_phase([&](std::size_t begin, std::size_t end) { return caster.cast_blend(begin, end, true, stop_); }))
        return false;
    }
    if (!look.lighting) return true;
    const auto cast_light = [&](std::size_t begin, std::size_t end) {
      return caster.cast_light(begin, end, true, stop_);
    };
    caster.start_light(*look.lighting, look.shader);
    if (!finish_phase(cast_light)) return false;
    caster.reuse_shadow_samples();
    return finish_phase(cast_light);
  }

 private:
  /// Casts rays until each ray is finished, and uploads the data that they miss. `cast` casts one pass over pixels
  /// [begin, end), like Caster::cast(). Returns false if `stop` cancelled the rays.
  template <class Cast>
  bool finish_phase(const Cast& cast) {
    GroupRays groups(stream_, camera_.eye, stop_, counts_, groups_of(tile_, stream_.casts_on_host()));
    const RaysState state = groups.finish(cast);
    return state == RaysState::too_little_memory ? finish_in_parts(cast) : state == RaysState::finished;
  }

  /// Like finish_phase(), with pools that cannot hold the working set: processes fewer pixels at a time.
  template <class Cast>
  bool finish_in_parts(const Cast& cast) {
    const std::size_t count = std::size_t(tile_.width) * std::size_t(tile_.height);
    for (std::size_t begin = 0, many = std::max<std::size_t>(count / 2, 1); begin < count;) {
      const std::size_t end = std::min(begin + many, count);
      const std::size_t waiting = cast(begin, end);
      if (stop_ && stop_()) return false;
      ++counts_.passes;
      if (waiting == 0) {
        begin = end;
        many *= 2;
        continue;
      }
      const std::uint32_t pass = stream_.caster().pass();
      const SceneStream::Served served = stream_.serve(stream_.caster().requested(), camera_.eye, stop_, {pass, false});
      if (served.evicted_used && many > 1) many /= 2;
      counts_.page_waits += served.misses_pages ? 1 : 0;
      if (!wait_for_served_pages(stream_, served, stop_)) return false;
      stream_.begin_pass();
    }
    return true;
  }

  SceneStream& stream_;
  const kernels::CastCamera& camera_;
  const kernels::CastTile& tile_;
  const kernels::StopAsked& stop_;
  PassCounts& counts_;
};

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
                 const RenderSettings& look, const kernels::StopAsked& stop, Picture& picture, PassCounts& counts) {
  if (!TileRays(stream, camera, tile, stop, counts).finish(look)) return false;
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
  PassCounts counts;
  for (const kernels::CastTile& tile : tiles_of(camera.width, camera.height, stream.tile_edge()))
    render_tile(stream, camera, tile, look, {}, picture, counts);
  return picture;
}

}  // namespace gigabake
