#include "format/edit/source_edits_in_scene.h"

#include <algorithm>
#include <cmath>

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
  if (!area_) return {p.x, p.y, height_m_};
  constexpr int steps = 5;  // each reduces the error by the square of the tilt of the vertical, at most about 0.01
  for (int i = 0; i < steps; ++i) p.z += height_m_ - geodetic_of((*ecef_from_scene_)(p)).height_m;
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
  if (!area_) return {height_m_, height_m_};
  const BoxSamples samples = samples_of([&](double x, double y, double z) {
    const auto at = [&](std::size_t c, double f) { return box.low[c] * (1 - f) + box.high[c] * f; };
    return moved({at(0, x), at(1, y), at(2, z)});
  });
  const auto [low, high] =
      std::minmax_element(samples.begin(), samples.end(), [](const auto& a, const auto& b) { return a.z < b.z; });
  const double margin_m = high->z - low->z;  // the surface bends by less between the samples
  return {low->z - margin_m, high->z + margin_m};
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
