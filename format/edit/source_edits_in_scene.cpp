#include "format/edit/source_edits_in_scene.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "core/base/error.h"
#include "core/math/georeference.h"
#include "format/edit/source_edit_json.h"
#include "format/system/hash_bytes.h"

namespace gigabake {
namespace {

AreaPolygon polygon_of(const SourceEdit& edit) {
  std::vector<Ring> rings;
  for (const PrismShape::Ring& ring : edit.rings) {
    rings.emplace_back();
    for (const auto& at : ring) rings.back().push_back({to_fixed(at[0]), to_fixed(at[1])});
  }
  return AreaPolygon(std::move(rings));
}

Hash128 hash_of_text(const SourceEdit& edit) {
  const std::string text = to_json(edit);
  return hash_of_bytes({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
}

}  // namespace

SourceEditInScene::SourceEditInScene(const SourceEdit& edit, const std::optional<Geodetic>& origin)
    : type_(edit.type),
      polygon_(polygon_of(edit)),
      height_m_(edit.height_m),
      by_m_(edit.by_m),
      hash_(hash_of_text(edit)) {
  if (!edit.through.empty()) {
    const auto& [a, b, c] = std::tie(edit.through[0], edit.through[1], edit.through[2]);
    const double bx = b[0] - a[0], by = b[1] - a[1], bz = b[2] - a[2], cx = c[0] - a[0], cy = c[1] - a[1],
                 cz = c[2] - a[2], area = bx * cy - by * cx;
    height_m_ = a[2], level_at_ = {a[0], a[1]};
    slope_ = {(bz * cy - cz * by) / area, (cz * bx - bz * cx) / area};
  }
  if (edit.frame == EditFrame::scene) return;
  if (!origin)
    throw UsageError(InputError(edit.file, edit.key,
                                "is in degrees, but the scene has no place on the earth; use metres of the scene")
                         .what());
  const FixedBox& box = polygon_.bounds();
  middle_longitude_ = (double(box.low.x) + double(box.high.x)) / (2 * fixed_per_unit);
  Area area;
  area.polygons.push_back(polygon_);
  area_.emplace(std::make_shared<const Area>(std::move(area)), origin);
  ecef_from_scene_ = ecef_from_enu(*origin);
}

std::array<double, 2> SourceEditInScene::in_plane(const Point<Scene>& p) const {
  if (!area_) return {p.x, p.y};
  const Geodetic g = geodetic_of((*ecef_from_scene_)(p));
  return {middle_longitude_ + std::remainder(g.longitude_deg - middle_longitude_, full_turn_degrees), g.latitude_deg};
}

Point<Scene> SourceEditInScene::moved(Point<Scene> p) const {
  if (type_ == SourceEditType::raise) return {p.x, p.y, p.z + by_m_};
  const double height_m = height_at(in_plane(p));
  if (!area_) return {p.x, p.y, height_m};
  constexpr int steps = 5;  // each reduces the error by the square of the tilt of the vertical, at most about 0.01
  for (int i = 0; i < steps; ++i) p.z += height_m - geodetic_of((*ecef_from_scene_)(p)).height_m;
  return p;
}

AreaOverlap SourceEditInScene::overlap(const SceneRange& box) const {
  if (area_) return area_->overlap(box);
  return polygon_.overlap(
      {{to_fixed(box.low[0]), to_fixed(box.low[1])}, {to_fixed(box.high[0]), to_fixed(box.high[1])}});
}

bool SourceEditInScene::affects(const SceneRange& box) const {
  return overlap(box) != (type_ == SourceEditType::inside ? AreaOverlap::inside : AreaOverlap::outside);
}

std::array<double, 2> SourceEditInScene::moved_range(const SceneRange& box) const {
  if (type_ == SourceEditType::raise) return {box.low[2] + by_m_, box.high[2] + by_m_};
  const BoxSamples samples = samples_of([&](double x, double y, double z) {
    const auto at = [&](std::size_t c, double f) { return box.low[c] * (1 - f) + box.high[c] * f; };
    return moved({at(0, x), at(1, y), at(2, z)});
  });
  const auto [low, high] =
      std::minmax_element(samples.begin(), samples.end(), [](const auto& a, const auto& b) { return a.z < b.z; });
  const double margin_m = high->z - low->z;  // the surface bends by less between the samples
  return {low->z - margin_m, high->z + margin_m};
}

double SourceEditInScene::height_at(const std::array<double, 2>& at) const {
  const FixedBox& box = polygon_.bounds();
  const auto beyond = [](double value, std::int64_t low, std::int64_t high) {
    return std::clamp(value, double(low) / fixed_per_unit, double(high) / fixed_per_unit);
  };
  return height_m_ + slope_[0] * (beyond(at[0], box.low.x, box.high.x) - level_at_[0]) +
         slope_[1] * (beyond(at[1], box.low.y, box.high.y) - level_at_[1]);
}

SourceEditsInScene placed_edits(const SourceEdits& edits, const std::optional<Geodetic>& origin) {
  SourceEditsInScene placed;
  for (const SourceEdit& edit : edits.list) placed.emplace_back(edit, origin);
  return placed;
}

SceneRange range_of(const SnapFrame& frame, const Box3i64& voxels) {
  SceneRange range;
  for (std::size_t c = 0; c < 3; ++c) {
    range.low[c] = frame.lattice_origin_m[c] + double(voxels.min[c] - 1) * frame.voxel_size_m;
    range.high[c] = frame.lattice_origin_m[c] + double(voxels.end[c] + 1) * frame.voxel_size_m;
  }
  return range;
}

}  // namespace gigabake
