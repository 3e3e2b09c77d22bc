#include "format/edit/edits_in_scene.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include "core/base/error.h"
#include "core/math/georeference.h"
#include "core/octree/brick.h"
#include "core/octree/morton.h"

namespace gigabake {
namespace {

/// Edits are listed by blocks of 2^block_bits × 2^block_bits columns of voxels.
constexpr int block_bits = 10;
constexpr std::int64_t max_blocks = 1024;
/// Max distance of two corners of a shape in degrees whose bounds are estimated from samples.
constexpr double max_diagonal_m = 300e3;
/// Min distance of a shape in degrees from a pole.
constexpr double min_from_pole_degrees = 3;

const std::string too_wide = "is wider than " + std::to_string(max_shape_edge / subvoxels) + " voxels";

std::int64_t centre_of(std::int64_t voxel) { return voxel * subvoxels + subvoxels / 2; }

Vec3i64 centre_of(const Vec3i64& voxel) { return {centre_of(voxel[0]), centre_of(voxel[1]), centre_of(voxel[2])}; }

LatticeBox centres_of(const Box3i64& voxels) {
  return {centre_of(voxels.min), centre_of(voxels.end - Vec3i64::all(1))};
}

bool are_apart(const Box3i64& a, const Box3i64& b) { return intersection(a, b).is_empty(); }

std::uint64_t block_key(std::int64_t x, std::int64_t y) { return morton(std::uint32_t(x), std::uint32_t(y)); }

/// Returns the blocks of columns that a box overlaps: [min, end) along x and y.
Box3i64 blocks_of(const Box3i64& box) {
  return {box.min >> block_bits, ((box.end - Vec3i64::all(1)) >> block_bits) + Vec3i64::all(1)};
}

}  // namespace

/// Converts the shapes of a list to the lattice.
class EditsInScene::Placer {
 public:
  Placer(const std::optional<Geodetic>& origin, const SnapFrame& frame) : origin_(origin), frame_(frame) {
    if (origin_) scene_from_ecef_ = gigabake::scene_from_ecef(*origin_);
  }

  PlacedEdit placed(const Edit& edit) {
    edit_ = &edit;
    if (edit.frame == EditFrame::degrees && !origin_)
      fail("is in degrees, but the scene has no place on the earth; use metres of the scene");
    PlacedEdit out{LatticeShape{}, {}, hash_of(edit)};
    std::visit([&](const auto& shape) { place(shape, out); }, edit.shape);
    return out;
  }

 private:
  [[noreturn]] void fail(const std::string& message) const { refuse(*edit_, message); }

  bool is_degrees() const { return edit_->frame == EditFrame::degrees; }

  /// Rounds metres to sub-voxels, like snap().
  std::int64_t sub_voxels(double metres) const {
    const double q = metres / frame_.voxel_size_m * double(subvoxels);
    if (!(std::fabs(q) < snap_limit)) fail("lies too far from the lattice's origin, or is too large, for its voxels");
    return std::int64_t(std::floor(q + 0.5));
  }

  std::int64_t on_axis(double metres, std::size_t axis) const {
    return sub_voxels(metres - frame_.lattice_origin_m[axis]);
  }

  Vec3i64 on_lattice(const Point<Scene>& p) const { return {on_axis(p.x, 0), on_axis(p.y, 1), on_axis(p.z, 2)}; }

  Point<Scene> in_scene(const std::array<double, 3>& at) const {
    if (!is_degrees()) return {at[0], at[1], at[2]};
    return (*scene_from_ecef_)(ecef_of({at[1], at[0], at[2]}));
  }

  void set(LatticeShape shape, PlacedEdit& out) const {
    const LatticeBox box = bounds_of(shape);
    for (std::size_t c = 0; c < 3; ++c)
      if (box.high[c] - box.low[c] > max_shape_edge) fail(too_wide);
    out.bounds = {box.low >> subvoxel_bits, (box.high >> subvoxel_bits) + Vec3i64::all(1)};
    out.shape = std::move(shape);
  }

  void place(const BoxShape& box, PlacedEdit& out) const {
    if (!is_degrees()) return set(LatticeBox{on_lattice(in_scene(box.low)), on_lattice(in_scene(box.high))}, out);
    Area area;
    area.bounds = bounds_in_degrees({to_fixed(box.low[0]), to_fixed(box.low[1])},
                                    {to_fixed(box.high[0]), to_fixed(box.high[1])}, box.low[2], box.high[2]);
    set(area, box.low, box.high, out);
  }

  void place(const SphereShape& sphere, PlacedEdit& out) const {
    set(LatticeSphere{on_lattice(in_scene(sphere.centre)), sub_voxels(sphere.radius_m)}, out);
  }

  void place(const CylinderShape& cylinder, PlacedEdit& out) const {
    std::array<double, 3> top = cylinder.base;
    top[2] += cylinder.height_m;
    const Vec3i64 base = on_lattice(in_scene(cylinder.base));
    set(LatticeCylinder{base, on_lattice(in_scene(top)) - base, sub_voxels(cylinder.radius_m)}, out);
  }

  void place(const PrismShape& prism, PlacedEdit& out) const {
    std::vector<Ring> rings;
    for (const PrismShape::Ring& ring : prism.rings) {
      rings.emplace_back();
      for (const auto& at : ring)
        rings.back().push_back(is_degrees() ? FixedPoint{to_fixed(at[0]), to_fixed(at[1])}
                                            : FixedPoint{on_axis(at[0], 0), on_axis(at[1], 1)});
    }
    AreaPolygon polygon(std::move(rings));
    if (!is_degrees())
      return set(LatticePrism{std::move(polygon), on_axis(prism.low_m, 2), on_axis(prism.high_m, 2)}, out);
    const FixedBox around = polygon.bounds();
    Area area;
    area.bounds = bounds_in_degrees(around.low, {around.high.x + 1, around.high.y + 1}, prism.low_m, prism.high_m);
    area.polygons.push_back(std::move(polygon));
    const auto degrees = [](std::int64_t fixed) { return double(fixed) / fixed_per_unit; };
    set(area, {degrees(around.low.x), degrees(around.low.y), prism.low_m},
        {degrees(around.high.x), degrees(around.high.y), prism.high_m}, out);
  }

  void place(const MeshShape& mesh, PlacedEdit& out) const {
    std::optional<Affine<Scene, Scene>> scene_from_mesh;
    if (is_degrees())
      scene_from_mesh = *scene_from_ecef_ * ecef_from_enu({mesh.place[1], mesh.place[0], mesh.place[2]});
    std::vector<Vec3i64> positions;
    for (const auto& at : mesh.positions_m) {
      const Point<Scene> p{at[0], at[1], at[2]};
      positions.push_back(on_lattice(scene_from_mesh ? (*scene_from_mesh)(p) : p));
    }
    if (const auto fault = open_edges(positions, mesh.triangles)) fail(*fault);
    expect_narrow(positions);
    try {
      set(LatticeMesh(std::move(positions), mesh.triangles), out);
    } catch (const std::length_error& e) {
      fail(e.what());
    }
  }

  void expect_narrow(const std::vector<Vec3i64>& positions) const {
    Vec3i64 low = positions.at(0), high = low;
    for (const Vec3i64& p : positions) low = min_by_axis(low, p), high = max_by_axis(high, p);
    for (std::size_t c = 0; c < 3; ++c)
      if (high[c] - low[c] > max_shape_edge) fail(too_wide);
  }

  static AreaBounds bounds_in_degrees(const FixedPoint& low, const FixedPoint& high, double low_m, double high_m) {
    return {AreaFrame::degrees, low, high, low_m, high_m};
  }

  /// Sets the shape of an area. The bounds of its box contain the samples of the box, extended by twice their max
  /// deviation from a linear map.
  void set(const Area& area, const std::array<double, 3>& low, const std::array<double, 3>& high,
           PlacedEdit& out) const {
    const auto at = [&](std::size_t c, double fraction) { return low[c] * (1 - fraction) + high[c] * fraction; };
    const BoxSamples samples = samples_of([&](double x, double y, double z) {
      return in_scene({at(0, x), at(1, y), at(2, z)});
    });
    const Point<Scene>&a = samples.front(), &b = samples.back();
    if (!(std::hypot(b.x - a.x, b.y - a.y, b.z - a.z) <= max_diagonal_m && high[0] - low[0] < 90) ||
        std::max(std::fabs(low[1]), std::fabs(high[1])) > max_latitude_degrees - min_from_pole_degrees)
      fail("is wider than 300 km, or near a pole; use metres of the scene");
    Vec3i64 min{}, max{};
    for (std::size_t c = 0; c < 3; ++c) {
      const auto [lowest_m, highest_m] = interval_of(samples, c);
      min[c] = on_axis(lowest_m, c), max[c] = on_axis(highest_m, c);
      if (max[c] - min[c] > max_shape_edge) fail(too_wide);
    }
    out.bounds = {(min >> subvoxel_bits) - Vec3i64::all(1), (max >> subvoxel_bits) + Vec3i64::all(2)};
    out.shape = AreaInScene(std::make_shared<const Area>(area), origin_);
  }

  static std::pair<double, double> interval_of(const BoxSamples& samples, std::size_t axis) {
    const auto value = [&](std::size_t i) {
      return axis == 0 ? samples[i].x : (axis == 1 ? samples[i].y : samples[i].z);
    };
    double low = value(0), high = low, deviation = 0;
    for (std::size_t i = 0; i < samples.size(); ++i) {
      low = std::min(low, value(i)), high = std::max(high, value(i));
      for (const std::size_t step : {1, 3, 9})
        if (i / step % 3 == 1)
          deviation = std::max(deviation, std::fabs(value(i) - (value(i - step) / 2 + value(i + step) / 2)));
    }
    return {low - 2 * deviation, high + 2 * deviation};
  }

  const std::optional<Geodetic>& origin_;
  const SnapFrame& frame_;
  std::optional<Affine<Scene, Ecef>> scene_from_ecef_;
  const Edit* edit_ = nullptr;
};

EditsInScene::EditsInScene(std::shared_ptr<const EditList> edits, const std::optional<Geodetic>& origin,
                           const SnapFrame& frame)
    : edits_(std::move(edits)), frame_(frame) {
  Placer placer(origin, frame_);
  placed_.reserve(edits_->size());
  for (const Edit& edit : *edits_) {
    const auto index = std::uint32_t(placed_.size());
    placed_.push_back(placer.placed(edit));
    const Box3i64 blocks = blocks_of(placed_.back().bounds);
    const Vec3i64 size = blocks.size();
    if (size[0] > max_blocks || size[1] > max_blocks || size[0] * size[1] > max_blocks) {
      wide_.push_back(index);
      continue;
    }
    for (std::int64_t y = blocks.min[1]; y < blocks.end[1]; ++y)
      for (std::int64_t x = blocks.min[0]; x < blocks.end[0]; ++x) by_block_[block_key(x, y)].push_back(index);
  }
}

std::vector<std::uint32_t> EditsInScene::near(const Box3i64& box) const {
  std::vector<std::uint32_t> out = wide_;
  const Box3i64 blocks = blocks_of(box);
  for (std::int64_t y = blocks.min[1]; y < blocks.end[1]; ++y)
    for (std::int64_t x = blocks.min[0]; x < blocks.end[0]; ++x)
      if (const auto found = by_block_.find(block_key(x, y)); found != by_block_.end())
        out.insert(out.end(), found->second.begin(), found->second.end());
  std::erase_if(out, [&](std::uint32_t i) { return are_apart(placed_[i].bounds, box); });
  std::sort(out.begin(), out.end());
  out.erase(std::unique(out.begin(), out.end()), out.end());
  return out;
}

std::vector<std::uint32_t> EditsInScene::selecting(const Box3i64& cube) const {
  std::vector<std::uint32_t> out = near(cube);
  std::erase_if(out, [&](std::uint32_t i) { return !selects_any(i, cube); });
  return out;
}

bool EditsInScene::selects_any(std::uint32_t i, const Box3i64& cube) const {
  const AreaOverlap whole = overlap(i, cube);
  if (whole != AreaOverlap::border) return whole == AreaOverlap::inside;
  const std::int64_t edge = cube.size()[0];
  if (edge == brick_edge) return selected(i, cube.min) != BrickMask{};
  for (int child = 0; child < 8; ++child) {
    const Vec3i64 at{child & 1, child >> 1 & 1, child >> 2};
    if (selects_any(i, Box3i64::cube(cube.min + at * (edge / 2), edge / 2))) return true;
  }
  return false;
}

AreaOverlap EditsInScene::overlap(std::uint32_t i, const Box3i64& voxels) const {
  const PlacedEdit& placed = placed_[i];
  if (are_apart(placed.bounds, voxels)) return AreaOverlap::outside;
  if (const auto* shape = std::get_if<LatticeShape>(&placed.shape))
    return gigabake::overlap(*shape, centres_of(voxels));
  return std::get<AreaInScene>(placed.shape).overlap(frame_, voxels);
}

BrickMask EditsInScene::selected(std::uint32_t i, const Vec3i64& min) const {
  if (const auto* area = std::get_if<AreaInScene>(&placed_[i].shape)) return area->inside(frame_, min);
  BrickMask mask{};
  for (std::int64_t z = 0; z < brick_edge; ++z)
    for (std::int64_t y = 0; y < brick_edge; ++y)
      for (std::int64_t x = 0; x < brick_edge; ++x)
        if (selects(i, min + Vec3i64{x, y, z})) mask[std::size_t(z)] |= std::uint64_t(1) << (x + brick_edge * y);
  return mask;
}

bool EditsInScene::selects(std::uint32_t i, const Vec3i64& voxel) const {
  const PlacedEdit& placed = placed_[i];
  if (!placed.bounds.contains(voxel)) return false;
  if (const auto* shape = std::get_if<LatticeShape>(&placed.shape)) return contains(*shape, centre_of(voxel));
  const auto at = [&](std::size_t c) {
    return frame_.lattice_origin_m[c] + (double(voxel[c]) + 0.5) * frame_.voxel_size_m;
  };
  return std::get<AreaInScene>(placed.shape).contains({at(0), at(1), at(2)});
}

}  // namespace gigabake
