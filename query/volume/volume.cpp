#include "query/volume/volume.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <numbers>
#include <tuple>
#include <utility>
#include <vector>

#include "core/base/error.h"
#include "core/math/georeference.h"
#include "core/octree/parameters.h"
#include "query/query_frames.h"
#include "query/surface_height.h"
#include "query/volume/column_area.h"

namespace gigabake {
namespace {

constexpr double units_per_m = 0x1p20;
constexpr std::size_t columns_per_range = 1024;

using WideSum = __int128;

std::int64_t units(double metres) { return std::llround(metres * units_per_m); }

/// Returns the local vertical in the earth-centred frame.
Vec3d up_in_ecef(double longitude_deg, double latitude_deg) {
  constexpr double radians_per_degree = std::numbers::pi / 180;
  const double longitude = longitude_deg * radians_per_degree, latitude = latitude_deg * radians_per_degree;
  return {std::cos(latitude) * std::cos(longitude), std::cos(latitude) * std::sin(longitude), std::sin(latitude)};
}

/// The sums of one thread, in 2^-20 m times the cross-section of a column.
struct Sums {
  WideSum cut = 0, fill = 0, cut_error = 0, fill_error = 0;
  VolumeColumns columns;

  /// Adds a column. `drop` is the height from the surface down to the reference.
  void add(std::int64_t drop, std::int64_t error, bool is_at_outline) {
    ++columns.measured;
    const std::int64_t cut_here = std::max<std::int64_t>(drop, 0), fill_here = std::max<std::int64_t>(-drop, 0);
    cut += cut_here, fill += fill_here;
    if (drop > -error) cut_error += error;
    if (drop < error) fill_error += error;
    if (is_at_outline) cut_error += cut_here, fill_error += fill_here;
  }
  void add_unmeasured(QueryOutcome outcome) {
    if (outcome == QueryOutcome::missing) ++columns.missing;
    if (outcome == QueryOutcome::outside) ++columns.outside;
    if (outcome == QueryOutcome::nothing) ++columns.without_surface;
  }
  void add(const Sums& s) {
    cut += s.cut, fill += s.fill, cut_error += s.cut_error, fill_error += s.fill_error;
    columns.measured += s.columns.measured, columns.without_surface += s.columns.without_surface;
    columns.outside += s.columns.outside, columns.missing += s.columns.missing;
  }
};

/// The first hits of a scene from above, in the columns of a scene that may be another one.
class ColumnHits {
 public:
  /// `columns_origin` is the origin of the scene with the columns.
  ColumnHits(SceneQuery& query, const Geodetic& columns_origin)
      : query_(query),
        frames_(query.scene().header(), query.window(), QueryFrame::scene),
        surface_(parameters_from_json(query.scene().header().parameters).surface) {
    const Geodetic& origin = *query.scene().header().origin;
    if (origin == columns_origin) return;
    from_columns_ = scene_from_ecef(origin) * ecef_from_enu(columns_origin);
  }

  /// Returns the z coordinate, in the frame of the columns, above which the scene has no cells.
  double top_m(const Geodetic& columns_origin) const {
    const SceneHeader& scene = query_.scene().header();
    const kernels::VoxelBox& window = query_.window();
    const bool is_same = *scene.origin == columns_origin;
    const Affine<Scene, Scene> to_columns =
        is_same ? Affine<Scene, Scene>{} : scene_from_ecef(columns_origin) * ecef_from_enu(*scene.origin);
    double top = -std::numeric_limits<double>::infinity();
    for (unsigned corner = 0; corner < 8; ++corner) {
      const Vec3d p = Vec3d::by_axis([&](std::size_t a) {
        const std::int64_t voxel = (corner >> a & 1u) != 0 ? window.max[a] + 1 : window.min[a] - 1;
        return scene.lattice_origin_m[a] + double(voxel) * scene.voxel_size_m;
      });
      top = std::fmax(top, to_columns({p[0], p[1], p[2]}).z);
    }
    return top;
  }

  /// Casts a ray down each column from z = top_m.
  void cast(const std::vector<AreaColumn>& columns, double top_m, const ThreadPool& pool, const Progress& progress) {
    rays.resize(columns.size());
    hits.resize(columns.size());
    const auto& m = from_columns_.m;
    pool.parallel_for(columns.size(), columns_per_range, [&](std::size_t begin, std::size_t end, int) {
      for (std::size_t i = begin; i < end; ++i) {
        const Point<Scene> p = from_columns_({columns[i].x_m, columns[i].y_m, top_m});
        rays[i] = frames_.ray({p.x, p.y, p.z}, {-m[0][2], -m[1][2], -m[2][2]});
      }
    });
    query_.first_hits(rays, hits, progress);
    move_to_surface(query_, surface_, rays, hits, progress);
  }

  const QueryFrames& frames() const { return frames_; }
  std::int64_t depth(std::size_t i) const { return units(frames_.metres(hits[i].distance)); }
  std::int64_t error(std::size_t i) const {
    return units(frames_.metres(height_error_edges * kernels::power_of_two(hits[i].lod)));
  }

  std::vector<QueryRay> rays;
  std::vector<QueryHit> hits;

 private:
  SceneQuery& query_;
  QueryFrames frames_;
  SurfaceRule surface_;
  Affine<Scene, Scene> from_columns_;
};

/// Returns an order of scenes that does not depend on which one is compared with the other.
auto order_of(const SceneQuery& query) {
  const SceneHeader& s = query.scene().header();
  return std::tuple(s.voxel_size_m, s.origin->latitude_deg, s.origin->longitude_deg, s.origin->height_m,
                    s.lattice_origin_m, query.window().min, query.window().max);
}

class Measurement {
 public:
  Measurement(const VolumeJob& job, SceneQuery& scene, SceneQuery* other, const ThreadPool& pool,
              const Progress& progress)
      : job_(job),
        pool_(pool),
        progress_(progress),
        columns_of_(other != nullptr && order_of(*other) < order_of(scene) ? *other : scene),
        origin_(*columns_of_.scene().header().origin),
        area_(job.area, columns_of_.scene().header(), columns_of_.window(), job.lod),
        scene_(scene, origin_),
        top_m_(scene_.top_m(origin_)),
        up_(up_in_ecef(origin_.longitude_deg, origin_.latitude_deg)) {
    if (other == nullptr) return;
    other_.emplace(*other, origin_);
    top_m_ = std::fmax(top_m_, other_->top_m(origin_));
  }

  Volume all() {
    const std::uint64_t beyond = area_.for_each_block([&](const ColumnArea::Block& block) {
      blocks_.push_back(block);
      if (blocks_.size() * ColumnArea::block_edge * ColumnArea::block_edge >= job_.batch_columns) measure_blocks();
    });
    measure_blocks();
    sums_.columns.outside += beyond;
    return volume();
  }

 private:
  void measure_blocks() {
    std::vector<std::vector<AreaColumn>> found(blocks_.size());
    pool_.parallel_for(blocks_.size(), 1, [&](std::size_t begin, std::size_t end, int) {
      for (std::size_t i = begin; i < end; ++i) found[i] = area_.columns_in(blocks_[i]);
    });
    blocks_.clear();
    std::vector<AreaColumn> columns;
    for (const auto& of_block : found) columns.insert(columns.end(), of_block.begin(), of_block.end());
    if (columns.empty()) return;
    scene_.cast(columns, top_m_, pool_, progress_);
    if (other_) other_->cast(columns, top_m_, pool_, progress_);
    std::vector<Sums> sums(std::size_t(pool_.threads()));
    pool_.parallel_for(columns.size(), columns_per_range, [&](std::size_t begin, std::size_t end, int thread) {
      for (std::size_t i = begin; i < end; ++i) add(i, columns[i].is_at_outline, sums[std::size_t(thread)]);
    });
    for (const Sums& s : sums) sums_.add(s);
  }

  void add(std::size_t i, bool is_at_outline, Sums& sums) const {
    const QueryOutcome outcome = outcome_of(i);
    if (outcome != QueryOutcome::hit) return sums.add_unmeasured(outcome);
    if (other_)
      sums.add(other_->depth(i) - scene_.depth(i), scene_.error(i) + other_->error(i), is_at_outline);
    else
      sums.add(units(above_reference_m(i)), scene_.error(i), is_at_outline);
  }

  /// Returns `missing` if a cell of either scene is missing, else `outside`, else `nothing`, else `hit`.
  QueryOutcome outcome_of(std::size_t i) const {
    const QueryOutcome a = scene_.hits[i].outcome, b = other_ ? other_->hits[i].outcome : QueryOutcome::hit;
    for (const QueryOutcome outcome : {QueryOutcome::missing, QueryOutcome::outside, QueryOutcome::nothing})
      if (a == outcome || b == outcome) return outcome;
    return QueryOutcome::hit;
  }

  /// Returns the length of the column between the surface and the reference height; negative if the surface is lower.
  /// The column is not parallel to the local vertical if it is far from the origin. In 100 km distance this changes the
  /// length by 0.01 %.
  double above_reference_m(std::size_t i) const {
    const QueryPoint p =
        scene_.frames().lonlat_point(scene_.frames().scene_point(scene_.rays[i], scene_.hits[i].distance));
    const Vec3d up = up_in_ecef(p[0], p[1]);
    return (p[2] - *job_.above_m) / (up[0] * up_[0] + up[1] * up_[1] + up[2] * up_[2]);
  }

  Volume volume() const {
    Volume v;
    v.column_m = area_.column_m();
    v.columns = sums_.columns;
    if (v.columns.all() == 0)
      throw UsageError(
          "volume",
          fmt::format("the area contains no centre of a column of voxels, which is {:g} m wide; expected a larger area",
                      v.column_m));
    if (v.columns.outside == v.columns.all())
      throw UsageError("volume", "the area lies outside the scenes; gigabake info prints their bounds");
    const double m3 = v.column_m * v.column_m / units_per_m;
    v.cut_m3 = double(sums_.cut) * m3;
    v.fill_m3 = double(sums_.fill) * m3;
    v.cut_error_m3 = double(sums_.cut_error) * m3;
    v.fill_error_m3 = double(sums_.fill_error) * m3;
    return v;
  }

  const VolumeJob& job_;
  const ThreadPool& pool_;
  const Progress& progress_;
  SceneQuery& columns_of_;  ///< the scene with the columns
  Geodetic origin_;         ///< its origin
  ColumnArea area_;
  ColumnHits scene_;
  std::optional<ColumnHits> other_;
  double top_m_;  ///< z coordinate above all cells
  Vec3d up_;      ///< the scene's z axis in the earth-centred frame
  std::vector<ColumnArea::Block> blocks_;
  Sums sums_;
};

}  // namespace

Volume measure_volume(const VolumeJob& job, SceneQuery& scene, SceneQuery* other, const ThreadPool& pool,
                      const Progress& progress) {
  progress.step("casting rays", 0, "ray");
  return Measurement(job, scene, other, pool, progress).all();
}

}  // namespace gigabake
