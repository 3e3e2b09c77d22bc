#include "format/area/area_in_scene.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/base/error.h"
#include "core/math/georeference.h"
#include "core/octree/brick.h"
#include "format/system/hash_bytes.h"

namespace gigabake {
namespace {

constexpr double metres_per_degree = 110e3;
/// Max half diagonal of a box whose coordinates are estimated from samples, in metres.
constexpr double max_half_diagonal_m = 300e3;
/// The error of a conversion to degrees or metres, with a large margin.
constexpr double conversion_error_degrees = 1e-9, conversion_error_m = 1e-4;
/// The number of times that a box near the border is halved along each axis.
constexpr int max_splits = 3;

const std::int64_t fixed_turn = to_fixed(full_turn_degrees);

Point<Scene> middle_of(const SceneRange& box) {
  const auto middle = [&](std::size_t c) { return box.low[c] / 2 + box.high[c] / 2; };
  return {middle(0), middle(1), middle(2)};
}

/// The number of samples along an axis of a box, and of its middle.
constexpr std::size_t samples = 3, middle_sample = 13;

double half_diagonal_m(const BoxSamples& box) {
  const Point<Scene>& middle = box[middle_sample];
  double max_m = 0;
  for (const Point<Scene>& p : box) max_m = std::max(max_m, std::hypot(p.x - middle.x, p.y - middle.y, p.z - middle.z));
  return max_m;
}

BoxSamples samples_of_range(const SceneRange& box) {
  const auto at = [&](std::size_t axis, double fraction) {
    return box.low[axis] * (1 - fraction) + box.high[axis] * fraction;
  };
  return samples_of([&](double x, double y, double z) { return Point<Scene>{at(0, x), at(1, y), at(2, z)}; });
}

/// Returns the interval that contains coordinate `axis` of a box, from the coordinates at samples. Extends the interval
/// of the samples by twice their max deviation from a linear map, which bounds the deviation between samples.
std::pair<double, double> interval_of(const std::vector<std::array<double, 3>>& values, std::size_t axis) {
  double low = values[0][axis], high = low, deviation = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    low = std::min(low, values[i][axis]), high = std::max(high, values[i][axis]);
    std::size_t step = 1;
    for (int along = 0; along < 3; ++along, step *= samples)
      if (i / step % samples == 1)
        deviation =
            std::max(deviation, std::fabs(values[i][axis] - (values[i - step][axis] / 2 + values[i + step][axis] / 2)));
  }
  return {low - 2 * deviation, high + 2 * deviation};
}

AreaOverlap interval_overlap(std::int64_t low, std::int64_t high, std::int64_t bound_low, std::int64_t bound_high) {
  if (high < bound_low || low >= bound_high) return AreaOverlap::outside;
  return low >= bound_low && high < bound_high ? AreaOverlap::inside : AreaOverlap::border;
}

AreaOverlap both(AreaOverlap a, AreaOverlap b) {
  if (a == AreaOverlap::outside || b == AreaOverlap::outside) return AreaOverlap::outside;
  return a == AreaOverlap::inside && b == AreaOverlap::inside ? AreaOverlap::inside : AreaOverlap::border;
}

AreaOverlap either(AreaOverlap a, AreaOverlap b) {
  if (a == AreaOverlap::inside || b == AreaOverlap::inside) return AreaOverlap::inside;
  return a == AreaOverlap::outside && b == AreaOverlap::outside ? AreaOverlap::outside : AreaOverlap::border;
}

FixedBox moved(const FixedBox& box, std::int64_t x) {
  return {{box.low.x + x, box.low.y}, {box.high.x + x, box.high.y}};
}

/// Calls `visit` with each number of units to the east that makes longitudes of a ring or of bounds comparable. Other
/// coordinates than degrees do not repeat.
template <class Visit>
void for_turns(AreaFrame frame, const Visit& visit) {
  visit(std::int64_t(0));
  if (frame != AreaFrame::degrees) return;
  visit(fixed_turn), visit(-fixed_turn);
}

bool spans_all(const AreaBounds& b) { return b.frame == AreaFrame::degrees && b.high.x - b.low.x >= fixed_turn; }

double coordinate(const SnapFrame& frame, std::size_t axis, std::int64_t voxel, int lod) {
  return frame.lattice_origin_m[axis] + (double(voxel) + 0.5) * std::ldexp(frame.voxel_size_m, lod);
}

/// Returns the box of the centres of voxels.
SceneRange centres_of(const SnapFrame& frame, const Box3i64& voxels, int lod) {
  SceneRange out;
  for (std::size_t c = 0; c < 3; ++c) {
    out.low[c] = coordinate(frame, c, voxels.min[c], lod);
    out.high[c] = coordinate(frame, c, voxels.end[c] - 1, lod);
  }
  return out;
}

/// Returns the bound if it cuts the interval, else an end of the range of coordinates.
std::int64_t cutting(std::int64_t bound, std::int64_t low, std::int64_t high, std::int64_t otherwise) {
  return bound > low && bound <= high ? bound : otherwise;
}

double cutting_height(double bound, double low, double high, double otherwise) {
  return bound > low && bound <= high ? bound : otherwise;
}

}  // namespace

AreaInScene::AreaInScene(std::shared_ptr<const Area> area, const std::optional<Geodetic>& origin)
    : area_(std::move(area)) {
  if (origin) ecef_from_scene_ = ecef_from_enu(*origin);
  if (is_on_earth(*area_) && !origin)
    throw UsageError(
        "the scene has no place on the earth, but the area has; set `origin`, or give bounds in scene metres with "
        "`crs` "
        "scene");
}

std::vector<std::array<double, 3>> AreaInScene::in_frame(AreaFrame frame, std::span<const Point<Scene>> points) const {
  std::vector<std::array<double, 3>> out;
  out.reserve(points.size());
  for (const Point<Scene>& p : points) {
    if (frame == AreaFrame::scene) {
      out.push_back({p.x, p.y, p.z});
      continue;
    }
    const Geodetic g = geodetic_of((*ecef_from_scene_)(p));
    out.push_back({g.longitude_deg, g.latitude_deg, g.height_m});
  }
  if (frame == AreaFrame::crs) area_->crs_map->convert(out);
  return out;
}

AreaInScene::AreaBox AreaInScene::box_in_frame(AreaFrame frame, const BoxSamples& box) const {
  AreaBox out;
  std::vector<std::array<double, 3>> values;
  if (frame == AreaFrame::scene) {
    values = in_frame(frame, box);
  } else {
    const double half_diagonal = half_diagonal_m(box);
    const Geodetic middle = geodetic_of((*ecef_from_scene_)(box[middle_sample]));
    const double from_pole_m = (90 - std::fabs(middle.latitude_deg)) * metres_per_degree;
    out.is_known = half_diagonal <= max_half_diagonal_m && from_pole_m > 2 * half_diagonal;
    if (!out.is_known) return out;
    values = in_frame(frame, box);
    for (auto& v : values) {
      out.is_known &= std::isfinite(v[0]) && std::isfinite(v[1]) && std::isfinite(v[2]);
      if (frame == AreaFrame::degrees)
        v[0] = middle.longitude_deg + std::remainder(v[0] - middle.longitude_deg, full_turn_degrees);
    }
    if (!out.is_known) return out;
  }
  std::array<std::pair<double, double>, 3> range;
  for (std::size_t c = 0; c < 3; ++c) {
    const bool is_degrees = frame == AreaFrame::degrees && c < 2;
    const double error = frame == AreaFrame::scene ? 0 : is_degrees ? conversion_error_degrees : conversion_error_m;
    range[c] = interval_of(values, c);
    range[c].first -= error, range[c].second += error;
  }
  out.plane = {{to_fixed(range[0].first), to_fixed(range[1].first)},
               {to_fixed(range[0].second), to_fixed(range[1].second)}};
  out.height_low_m = range[2].first, out.height_high_m = range[2].second;
  return out;
}

AreaOverlap AreaInScene::overlap_of_bounds(const AreaBox& box) const {
  const AreaBounds& b = *area_->bounds;
  if (!box.is_known) return AreaOverlap::border;
  AreaOverlap x = spans_all(b) ? AreaOverlap::inside : AreaOverlap::outside;
  for_turns(b.frame, [&](std::int64_t turn) {
    x = either(x, interval_overlap(box.plane.low.x + turn, box.plane.high.x + turn, b.low.x, b.high.x));
  });
  AreaOverlap z = AreaOverlap::border;
  if (box.height_high_m < b.height_low_m || box.height_low_m >= b.height_high_m) z = AreaOverlap::outside;
  if (box.height_low_m >= b.height_low_m && box.height_high_m < b.height_high_m) z = AreaOverlap::inside;
  return both(both(x, interval_overlap(box.plane.low.y, box.plane.high.y, b.low.y, b.high.y)), z);
}

AreaOverlap AreaInScene::overlap_of_polygons(const AreaBox& box) const {
  if (!box.is_known) return AreaOverlap::border;
  AreaOverlap out = AreaOverlap::outside;
  for (const AreaPolygon& polygon : area_->polygons)
    for_turns(AreaFrame::degrees,
              [&](std::int64_t turn) { out = either(out, polygon.overlap(moved(box.plane, turn))); });
  return out;
}

bool AreaInScene::is_in_bounds(const std::array<double, 3>& p) const {
  const AreaBounds& b = *area_->bounds;
  if (!std::isfinite(p[0]) || !std::isfinite(p[1])) return false;
  const FixedPoint at{to_fixed(p[0]), to_fixed(p[1])};
  if (at.y < b.low.y || at.y >= b.high.y || p[2] < b.height_low_m || !(p[2] < b.height_high_m)) return false;
  if (spans_all(b)) return true;
  bool is_inside = false;
  for_turns(b.frame, [&](std::int64_t turn) { is_inside |= at.x + turn >= b.low.x && at.x + turn < b.high.x; });
  return is_inside;
}

bool AreaInScene::is_in_polygons(const std::array<double, 3>& p) const {
  const FixedPoint at{to_fixed(p[0]), to_fixed(p[1])};
  bool is_inside = false;
  for (const AreaPolygon& polygon : area_->polygons)
    for_turns(AreaFrame::degrees, [&](std::int64_t turn) {
      is_inside = is_inside || polygon.contains({at.x + turn, at.y});
    });
  return is_inside;
}

bool AreaInScene::contains(const Point<Scene>& p) const {
  if (area_->bounds && !is_in_bounds(in_frame(area_->bounds->frame, {&p, 1})[0])) return false;
  return area_->polygons.empty() || is_in_polygons(in_frame(AreaFrame::degrees, {&p, 1})[0]);
}

AreaOverlap AreaInScene::overlap(const SceneRange& box) const { return overlap(samples_of_range(box)); }

AreaOverlap AreaInScene::overlap(const BoxSamples& box) const {
  AreaOverlap out = AreaOverlap::inside;
  if (area_->bounds) out = overlap_of_bounds(box_in_frame(area_->bounds->frame, box));
  if (out == AreaOverlap::outside || area_->polygons.empty()) return out;
  return both(out, overlap_of_polygons(box_in_frame(AreaFrame::degrees, box)));
}

AreaOverlap AreaInScene::refined_overlap(const SceneRange& box, int splits) const {
  const AreaOverlap whole = overlap(box);
  if (whole != AreaOverlap::border || splits == 0) return whole;
  const Point<Scene> middle = middle_of(box);
  const std::array<double, 3> cut{middle.x, middle.y, middle.z};
  std::optional<AreaOverlap> all;
  for (unsigned child = 0; child < 8; ++child) {
    SceneRange part = box;
    for (std::size_t c = 0; c < 3; ++c) (child >> c & 1u ? part.low : part.high)[c] = cut[c];
    const AreaOverlap of_part = refined_overlap(part, splits - 1);
    if (of_part == AreaOverlap::border || (all && *all != of_part)) return AreaOverlap::border;
    all = of_part;
  }
  return *all;
}

AreaOverlap AreaInScene::overlap(const SnapFrame& frame, const Box3i64& voxels, int lod) const {
  return refined_overlap(centres_of(frame, voxels, lod), max_splits);
}

BrickMask AreaInScene::inside(const SnapFrame& frame, const Vec3i64& min, int lod) const {
  BrickMask mask{};
  const AreaOverlap whole = overlap(centres_of(frame, Box3i64::cube(min, brick_edge), lod));
  if (whole == AreaOverlap::inside) mask.fill(~std::uint64_t(0));
  if (whole != AreaOverlap::border) return mask;
  std::vector<Point<Scene>> centres;
  for (std::int64_t z = 0; z < brick_edge; ++z)
    for (std::int64_t y = 0; y < brick_edge; ++y)
      for (std::int64_t x = 0; x < brick_edge; ++x)
        centres.push_back({coordinate(frame, 0, min[0] + x, lod), coordinate(frame, 1, min[1] + y, lod),
                           coordinate(frame, 2, min[2] + z, lod)});
  std::vector<std::array<double, 3>> in_bounds, in_polygons;
  if (area_->bounds) in_bounds = in_frame(area_->bounds->frame, centres);
  if (!area_->polygons.empty()) in_polygons = in_frame(AreaFrame::degrees, centres);
  for (std::size_t i = 0; i < centres.size(); ++i) {
    if (area_->bounds && !is_in_bounds(in_bounds[i])) continue;
    if (area_->polygons.empty() || is_in_polygons(in_polygons[i])) mask[i / 64] |= std::uint64_t(1) << i % 64;
  }
  return mask;
}

void AreaInScene::put_cutting_bounds(const BoxSamples& samples_in_box, ByteWriter& w) const {
  const AreaBounds& b = *area_->bounds;
  const AreaBox box = box_in_frame(b.frame, samples_in_box);
  w.put(b.frame), w.put(area_->crs), w.put(std::uint8_t(box.is_known));
  if (!box.is_known) return put(w, *area_);
  constexpr std::int64_t end = std::numeric_limits<std::int64_t>::max(), begin = -end;
  constexpr double infinity = std::numeric_limits<double>::infinity();
  for_turns(b.frame, [&](std::int64_t turn) {
    const std::int64_t low = box.plane.low.x + turn, high = box.plane.high.x + turn;
    if (spans_all(b) || interval_overlap(low, high, b.low.x, b.high.x) == AreaOverlap::outside) return;
    w.put(cutting(b.low.x, low, high, begin)), w.put(cutting(b.high.x, low, high, end));
  });
  w.put(cutting(b.low.y, box.plane.low.y, box.plane.high.y, begin));
  w.put(cutting(b.high.y, box.plane.low.y, box.plane.high.y, end));
  w.put(cutting_height(b.height_low_m, box.height_low_m, box.height_high_m, -infinity));
  w.put(cutting_height(b.height_high_m, box.height_low_m, box.height_high_m, infinity));
}

void AreaInScene::put_cutting_edges(const BoxSamples& samples_in_box, ByteWriter& w) const {
  const AreaBox box = box_in_frame(AreaFrame::degrees, samples_in_box);
  w.put(std::uint8_t(box.is_known));
  if (!box.is_known) return put(w, *area_);
  for (const AreaPolygon& polygon : area_->polygons)
    for_turns(AreaFrame::degrees, [&](std::int64_t turn) {
      const FixedBox at = moved(box.plane, turn);
      const std::vector<RingEdge> edges = polygon.edges_in(at);
      const bool is_inside = polygon.contains(at.low);
      if (edges.empty() && !is_inside) return;
      w.put(turn), w.put(std::uint8_t(is_inside)), w.put(std::uint64_t(edges.size()));
      w.put(at.low);
      for (const RingEdge& edge : edges) w.put(edge);
    });
}

Hash128 AreaInScene::border_hash(const SnapFrame& frame, const Box3i64& voxels) const {
  const BoxSamples range = samples_of_range(centres_of(frame, voxels, 0));
  ByteWriter w;
  if (area_->bounds) put_cutting_bounds(range, w);
  if (!area_->polygons.empty()) put_cutting_edges(range, w);
  return hash_of_bytes(w.take());
}

}  // namespace gigabake
