#include "app/process/point_export.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "app/options/map_crs.h"
#include "core/math/box3.h"
#include "format/export/las/las.h"
#include "format/scene/paged_scene.h"

namespace gigabake::app {
namespace {

constexpr double metres_per_degree = 111319.49;  // on the equator

/// Returns the box around all surfaces, in voxels of lod 0.
Box3i64 box_of(const PagedScene& scene) {
  if (!scene.header().bounds.is_empty()) return scene.header().bounds;
  Box3i64 box;
  scene.for_each_cell([&](const SceneCell& cell) { box = hull(box, window_of(cell)); });
  return box;
}

/// Sets the scale to the largest power of ten that is at most a thousandth of a voxel. A scene that is too wide for 32
/// bits gets a larger scale. The offset is near the middle of the points.
void set_scale(const PagedScene& scene, const MapFrame& map, LasFrame& las) {
  const SceneHeader& header = scene.header();
  const Box3i64 box = box_of(scene);
  std::vector<std::array<double, 3>> points;
  for (int i = 0; i < 27; ++i) {
    const Vec3d part{double(i % 3) / 2, double(i / 3 % 3) / 2, double(i / 9) / 2};
    std::array<double, 3>& p = points.emplace_back();
    for (std::size_t c = 0; c < 3; ++c)
      p[c] =
          header.lattice_origin_m[c] + std::lerp(double(box.min[c]), double(box.end[c]), part[c]) * header.voxel_size_m;
  }
  map.scene_to_map(points);
  const double unit_m = map.facts().is_in_degrees ? metres_per_degree : map.facts().metres_per_unit;
  for (std::size_t c = 0; c < 3; ++c) {
    const double voxel = header.voxel_size_m / (c < 2 ? unit_m : 1);
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (const auto& p : points) {
      if (!std::isfinite(p[c])) continue;  // export_las() reports a point without coordinates
      low = std::min(low, p[c]), high = std::max(high, p[c]);
    }
    int digits = int(std::floor(std::log10(voxel / 1000)));
    while (high - low > std::pow(10, digits) * double(1 << 30)) ++digits;
    las.scale[c] = std::pow(10, digits);
    const double round_to = std::pow(10, digits + 6);
    las.offset[c] = high >= low ? std::round((low + high) / 2 / round_to) * round_to : 0;
  }
}

}  // namespace

std::uint64_t export_points(const std::string& scene_xml, int lod, const std::string& crs, const std::string& las,
                            const Progress& progress) {
  const PagedScene scene(scene_xml);
  const MapFrame map = open_map_frame(scene.header(), crs, 1);
  LasFrame frame;
  frame.wkt = map.facts().wkt;
  if (!map.is_scene()) {
    frame.from_scene_m = [&map](std::span<std::array<double, 3>> points) { map.scene_to_map(points); };
    set_scale(scene, map, frame);
  }
  return export_las(scene_xml, lod, las, frame, progress);
}

}  // namespace gigabake::app
