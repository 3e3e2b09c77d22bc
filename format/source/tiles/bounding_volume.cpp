#include "format/source/tiles/bounding_volume.h"

#include <cmath>
#include <numbers>

#include "core/base/error.h"
#include "core/math/georeference.h"

namespace gigabake {
namespace {

constexpr double degrees_per_radian = 180 / std::numbers::pi;

BoundingVolume box_around(const std::array<double, 4>& sphere) {
  const double radius = std::fabs(sphere[3]);
  return {BoundingVolume::Shape::box, {sphere[0], sphere[1], sphere[2], radius, 0, 0, 0, radius, 0, 0, 0, radius}};
}

BoundingVolume region_of(const std::array<double, 6>& region) {
  BoundingVolume out{BoundingVolume::Shape::region, {}};
  std::copy(region.begin(), region.end(), out.values.begin());
  if (out.values[0] > out.values[2]) out.values[2] += 2 * std::numbers::pi;  // it crosses the antimeridian
  return out;
}

/// Returns the position in a box at fractions of its axes.
Point<World> position_in_box(const BoundingVolume& box, const std::array<double, 3>& fraction) {
  std::array<double, 3> p{box.values[0], box.values[1], box.values[2]};
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (std::size_t c = 0; c < 3; ++c) p[c] += (2 * fraction[axis] - 1) * box.values[3 + 3 * axis + c];
  return {p[0], p[1], p[2]};
}

}  // namespace

std::optional<BoundingVolume> bounding_volume(const JsonMembers& tile) {
  try {
    const JsonMembers volume = tile.members("boundingVolume");
    if (const auto region = volume.numbers<6>("region")) return region_of(*region);
    if (const auto box = volume.numbers<12>("box")) return BoundingVolume{BoundingVolume::Shape::box, *box};
    if (const auto sphere = volume.numbers<4>("sphere")) return box_around(*sphere);
  } catch (const InputError&) {
    // A tile with a malformed volume is read, as without an area.
  }
  return std::nullopt;
}

BoundingVolume volume_of(const BoundingVolume& root, bool is_octree, const TileCoordinates& place) {
  BoundingVolume out = root;
  const double parts = std::ldexp(1.0, int(place.level));
  const std::array<double, 3> at{double(place.x), double(place.y), double(place.z)};
  for (std::size_t axis = 0; axis < (is_octree ? 3u : 2u); ++axis) {
    if (root.shape == BoundingVolume::Shape::region) {
      const std::size_t low = axis < 2 ? axis : 4, high = axis < 2 ? axis + 2 : 5;
      const double size = (root.values[high] - root.values[low]) / parts;
      out.values[low] = root.values[low] + at[axis] * size;
      out.values[high] = root.values[low] + (at[axis] + 1) * size;
      continue;
    }
    for (std::size_t c = 0; c < 3; ++c) {
      const double half = root.values[3 + 3 * axis + c];
      out.values[c] += half * ((2 * at[axis] + 1) / parts - 1);
      out.values[3 + 3 * axis + c] = half / parts;
    }
  }
  return out;
}

BoundingVolume volume_of(const WorldBox& box) {
  BoundingVolume out;
  const Point<World> centre = box.centre();
  out.values = {centre.x, centre.y, centre.z};
  for (std::size_t c = 0; c < 3; ++c) out.values[3 + 4 * c] = (box.high[c] - box.low[c]) / 2;
  return out;
}

VolumeFilter::VolumeFilter(std::shared_ptr<const Area> area, const std::optional<Geodetic>& origin,
                           const Affine<Scene, World>& scene_from_world)
    : area_(std::move(area), origin), origin_(origin), scene_from_world_(scene_from_world) {}

bool VolumeFilter::may_overlap(const BoundingVolume& volume, const Affine<World, World>& world_from_tile) const {
  if (volume.shape == BoundingVolume::Shape::box) {
    const Affine<Scene, World> place = scene_from_world_ * world_from_tile;
    const BoxSamples box = samples_of([&](double x, double y, double z) {
      return place(position_in_box(volume, {x, y, z}));
    });
    return area_.overlap(box) != AreaOverlap::outside;
  }
  if (!origin_) return true;  // a region is a place on the earth, but the scene has none
  const auto& v = volume.values;
  const Affine<Scene, Ecef> scene_from_earth = scene_from_ecef(*origin_);
  const BoxSamples box = samples_of([&](double x, double y, double z) {
    const auto between = [](double low, double high, double fraction) { return low + (high - low) * fraction; };
    return scene_from_earth(
        ecef_of({std::clamp(between(v[1], v[3], y) * degrees_per_radian, -90.0, 90.0),
                 std::remainder(between(v[0], v[2], x) * degrees_per_radian, 360.0), between(v[4], v[5], z)}));
  });
  return area_.overlap(box) != AreaOverlap::outside;
}

}  // namespace gigabake
