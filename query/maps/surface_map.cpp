#include "query/maps/surface_map.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <stdexcept>
#include <vector>

#include "core/base/error.h"
#include "core/octree/parameters.h"
#include "query/surface_height.h"

namespace gigabake {
namespace {

constexpr std::size_t pixel_bytes = 4;
constexpr std::size_t pixels_per_range = 1024;

}  // namespace

struct SurfaceMap::State {
  State(SceneQuery& query, const MapFrame& frame, const MapJob& job, const ThreadPool& pool)
      : query_(query),
        frame_(frame),
        job_(job),
        pool_(pool),
        surface_(parameters_from_json(query.scene().header().parameters).surface),
        frames_(query.scene().header(), query.window(), frame.query_frame()) {}

  void make_block(std::uint32_t left, std::uint32_t top, const Progress& progress) {
    const std::uint32_t width = std::min(job_.block, job_.grid.columns - left),
                        height = std::min(job_.block, job_.grid.rows - top);
    const std::size_t pixels = std::size_t(width) * height;
    block_.resize(pixels * pixel_bytes);
    for (std::size_t first = 0; first < pixels; first += job_.batch_rays) {
      points_.resize(std::min(job_.batch_rays, pixels - first));
      for (std::size_t i = 0; i < points_.size(); ++i) {
        const std::size_t pixel = first + i;
        points_[i] = {job_.grid.x(left + std::uint32_t(pixel % width)), job_.grid.y(top + std::uint32_t(pixel / width)),
                      0};
      }
      cast(progress);
      fill(first);
    }
  }

  /// Casts a ray for each point that has a place.
  void cast(const Progress& progress) {
    rays_.resize(points_.size());
    has_place_.assign(points_.size(), 1);
    pool_.parallel_for(points_.size(), pixels_per_range, [&](std::size_t begin, std::size_t end, int thread) {
      frame_.to_query({&points_[begin], end - begin}, thread);
      for (std::size_t i = begin; i < end; ++i) try {
          rays_[i] = frames_.down(points_[i][0], points_[i][1]);
        } catch (const std::invalid_argument&) {
          has_place_[i] = 0;
        }
    });
    pixel_of_ray_.clear();
    for (std::size_t i = 0; i < points_.size(); ++i)
      if (has_place_[i] != 0) rays_[pixel_of_ray_.size()] = rays_[i], pixel_of_ray_.push_back(std::uint32_t(i));
    rays_.resize(pixel_of_ray_.size());
    hits_.resize(rays_.size());
    query_.first_hits(rays_, hits_, progress);
    progress.advance(points_.size() - rays_.size());
    if (job_.content == MapContent::heights) move_to_surface(query_, surface_, rays_, hits_, progress);
  }

  /// Writes the pixels of the batch, which begins at pixel `first` of the block.
  void fill(std::size_t first) {
    std::byte* const to = block_.data() + first * pixel_bytes;
    for (std::size_t i = 0; i < points_.size(); ++i) put_none(to + i * pixel_bytes);
    std::vector<MapTally> tallies(std::size_t(pool_.threads()));
    pool_.parallel_for(rays_.size(), pixels_per_range, [&](std::size_t begin, std::size_t end, int thread) {
      for (std::size_t r = begin; r < end; ++r) {
        const bool is_hit = hits_[r].outcome == QueryOutcome::hit && is_inside(r);
        if (is_hit) put(r, to + pixel_of_ray_[r] * pixel_bytes, thread);
        MapTally& tally = tallies[std::size_t(thread)];
        ++(is_hit                                                      ? tally.with_surface
           : hits_[r].outcome == QueryOutcome::missing && is_inside(r) ? tally.missing
                                                                       : tally.without_surface);
      }
    });
    tally_.without_surface += points_.size() - rays_.size();
    for (const MapTally& t : tallies) {
      tally_.with_surface += t.with_surface;
      tally_.without_surface += t.without_surface;
      tally_.missing += t.missing;
    }
  }

  bool is_inside(std::size_t r) const {
    return !job_.area || job_.area->contains(frames_.scene_point(rays_[r], hits_[r].distance));
  }

  void put_none(std::byte* to) const {
    constexpr float no_height = std::numeric_limits<float>::quiet_NaN();
    const std::int32_t none = job_.content == MapContent::heights   ? std::bit_cast<std::int32_t>(no_height)
                              : job_.content == MapContent::classes ? -1
                                                                    : 0;
    std::memcpy(to, &none, sizeof none);
  }

  void put(std::size_t r, std::byte* to, int thread) const {
    if (job_.content == MapContent::colours) {
      std::memcpy(to, &hits_[r].rgba, pixel_bytes);
      return;
    }
    if (job_.content == MapContent::classes) {
      const std::int32_t number = hits_[r].voxel_class;
      std::memcpy(to, &number, sizeof number);
      return;
    }
    const QueryPoint at = frames_.point_in_query_frame(frames_.scene_point(rays_[r], hits_[r].distance));
    std::array<double, 3> p{at[0], at[1], at[2]};
    if (frame_.facts().has_heights) frame_.to_map({&p, 1}, thread);
    const auto height = float(p[2]);
    std::memcpy(to, &height, sizeof height);
  }

  SceneQuery& query_;
  const MapFrame& frame_;
  const MapJob& job_;
  const ThreadPool& pool_;
  SurfaceRule surface_;
  QueryFrames frames_;
  MapTally tally_;
  std::vector<std::byte> block_;
  std::vector<std::array<double, 3>> points_;  ///< of a batch, like the members below
  std::vector<char> has_place_;
  std::vector<QueryRay> rays_;
  std::vector<std::uint32_t> pixel_of_ray_;
  std::vector<QueryHit> hits_;
};

namespace {

/// Returns the first multiple of a pixel's edge, and the number of pixels from there whose centres are below `high`.
std::pair<double, double> pixels_between(double low, double high, double step, bool is_exact) {
  // The centre of pixel i is low + (i + 1/2) step. A centre at `low` is inside, a centre at `high` is not.
  const double start = is_exact ? low : std::ceil(low / step - 0.5) * step;
  return {start, std::max(1.0, std::ceil((high - start) / step - 0.5))};
}

}  // namespace

MapGrid grid_of(const MapBox& box, double step, bool is_exact) {
  if (!(step > 0) || !std::isfinite(step)) throw UsageError("step", "expected a number above 0");
  if (box.is_empty()) throw UsageError("no part of the scene is inside");
  const auto [west, columns] = pixels_between(box.low[0], box.high[0], step, is_exact);
  const auto [south, rows] = pixels_between(box.low[1], box.high[1], step, is_exact);
  constexpr double maximum = std::numeric_limits<std::int32_t>::max();
  if (!(columns <= maximum && rows <= maximum))
    throw UsageError("step", "more than 2^31 - 1 pixels along an axis; expected a larger step or smaller bounds");
  return {west, south, step, std::uint32_t(columns), std::uint32_t(rows)};
}

SurfaceMap::SurfaceMap(SceneQuery& query, const MapFrame& frame, const MapJob& job, const ThreadPool& pool)
    : state_(std::make_unique<State>(query, frame, job, pool)) {}

SurfaceMap::~SurfaceMap() = default;

std::uint32_t SurfaceMap::block_columns() const {
  const MapJob& job = state_->job_;
  return (job.grid.columns + job.block - 1) / job.block;
}

std::uint64_t SurfaceMap::blocks() const {
  const MapJob& job = state_->job_;
  return std::uint64_t(block_columns()) * ((job.grid.rows + job.block - 1) / job.block);
}

std::span<const std::byte> SurfaceMap::block(std::uint64_t number, const Progress& progress) {
  const std::uint32_t edge = state_->job_.block;
  state_->make_block(std::uint32_t(number % block_columns()) * edge, std::uint32_t(number / block_columns()) * edge,
                     progress);
  return state_->block_;
}

const MapTally& SurfaceMap::tally() const { return state_->tally_; }

}  // namespace gigabake
