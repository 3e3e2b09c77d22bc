#include "viewer/pictures/camera.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>
#include <string>

#include "core/base/error.h"
#include "core/octree/brick.h"
#include "viewer/stream/overview_levels.h"

namespace gigabake {
namespace {

constexpr int max_image_edge = 32768;
constexpr std::int64_t max_pixels = std::int64_t(1) << 28;
constexpr double max_voxel = double(std::int64_t(1) << 40);

double length(const Vec3d& a) { return std::hypot(a[0], a[1], a[2]); }
Vec3d unit(const Vec3d& a) { return a * (1 / length(a)); }

void check_options(const CameraOptions& o) {
  check_picture_size(o);
  if (!(o.fovy_deg >= 0.01 && o.fovy_deg <= 170)) throw UsageError("fovy_deg", "expected 0.01 to 170 degrees");
  check_pixel_error(o.pixel_error);
}

/// Converts scene metres to voxels.
Vec3d to_voxels(const Point<Scene>& p_scene_m, const SceneHeader& scene, const char* name) {
  const Vec3d p_m{p_scene_m.x, p_scene_m.y, p_scene_m.z};
  const Vec3d v = (p_m - scene.lattice_origin_m) / scene.voxel_size_m;
  for (std::size_t a = 0; a < 3; ++a) {
    if (!std::isfinite(p_m[a])) throw UsageError(name, "expected three finite numbers");
    if (!(std::fabs(v[a]) <= max_voxel)) throw UsageError(name, "more than 2^40 voxels from the scene's origin");
  }
  return v;
}

/// An orthonormal, right-handed basis.
struct Axes {
  Vec3d forward, right, up;
};

Axes look(const Vec3d& forward, const std::optional<Point<Scene>>& up) {
  Vec3d upwards{0, 0, 1};
  if (up) {
    upwards = {up->x, up->y, up->z};
    const double size = length(upwards);
    if (!std::isfinite(size) || !(size > 0)) throw UsageError("up", "expected a finite direction other than 0,0,0");
    upwards = unit(upwards);
  } else if (std::fabs(forward[2]) > 1 - 1e-9) {
    upwards = {0, 1, 0};
  }
  const Vec3d right = cross(forward, upwards);
  if (!(length(right) > 1e-9)) throw UsageError("up", "the camera looks along it; choose another direction");
  return {forward, unit(right), cross(unit(right), forward)};
}

/// The direction of a view from the south-east, about 30° below the horizontal.
const Vec3d oblique_view{-0.62, 0.60, -0.505};

/// The maximum numbers of cells whose nodes are read, without and with a root overview. A scene of more cells is framed
/// by its root overview, or by the boxes of its cells if it has no root overview.
constexpr std::size_t max_cells_read = 256, max_cells_read_below_root = 32;

/// Calls visit(node, lowest corner, edge) for the finest nodes of `rows` in the tree below `row`. Corner and edge are
/// in lod-0 voxels. Descends only from nodes whose edge exceeds `minimum`.
template <class Visit>
void visit_nodes(const std::vector<NodeRow>& rows, std::size_t row, const Vec3d& corner, double edge, double minimum,
                 const Visit& visit) {
  const NodeRow& node = rows[row];
  const auto children = std::size_t(std::popcount(node.child_mask));
  if (edge <= minimum || children == 0 || node.first_child + children > rows.size()) return visit(node, corner, edge);
  std::size_t next = node.first_child;
  for (int child = 0; child < 8; ++child) {
    if ((node.child_mask >> child & 1) == 0) continue;
    const double half = edge / 2;
    visit_nodes(rows, next++, corner + Vec3d{child & 1 ? half : 0, child & 2 ? half : 0, child & 4 ? half : 0}, half,
                minimum, visit);
  }
}

/// Returns the page, or an empty page if it cannot be read. For framing, the box of the cell suffices; rendering
/// reports the error.
Page page_or_none(const PageSource& pages, const PageKey& key) {
  try {
    return pages(key);
  } catch (const InputError&) {
    return {};
  }
}

Vec3d corner_of(const SceneCell& shard) {
  return {double(shard.lattice_min[0]), double(shard.lattice_min[1]), double(shard.lattice_min[2])};
}

/// Calls visit(lowest corner, edge) for boxes that contain the occupied space, in lod-0 voxels.
template <class Visit>
void visit_cells(const PagedScene& scene, const PageSource& pages, const Visit& visit) {
  const auto visit_box = [&](const NodeRow&, const Vec3d& corner, double edge) { visit(corner, edge); };
  const bool few = scene.totals().cells <= max_cells_read;
  std::uint32_t number = 0;
  scene.for_each_cell([&](const SceneCell& cell) {
    const std::vector<NodeRow> rows =
        few ? page_or_none(pages, {number, PageKey::node_rows, 0}).rows : std::vector<NodeRow>();
    if (rows.empty())
      visit(corner_of(cell), double(cell.cell_voxels));
    else
      visit_nodes(rows, 0, corner_of(cell), double(cell.cell_voxels), 0, visit_box);
    ++number;
  });
}

/// Calls visit(lowest corner, edge) for the voxels of the finest level that the root stores but its children do not.
/// One page contains all bricks of this level. Returns false if a page cannot be read.
template <class Visit>
bool visit_root(const PagedScene& scene, std::uint32_t root, const PageSource& pages, const Visit& visit) {
  const SceneCell& shard = scene.root().overviews[root];
  const auto number = std::uint32_t(scene.totals().cells + root);
  const std::vector<NodeRow> rows = page_or_none(pages, {number, PageKey::node_rows, 0}).rows;
  const BrickBlock bricks = page_or_none(pages, {number, int(shard.copied_lods), 0}).bricks;
  if (rows.empty() || bricks.mask.empty()) return false;
  visit_nodes(rows, 0, corner_of(shard), double(shard.cell_voxels), std::ldexp(brick_edge, int(shard.own_lod())),
              [&](const NodeRow& node, const Vec3d& corner, double edge) {
                const bool is_brick = node.kind == NodeKind::brick && 8 * std::size_t(node.value) < bricks.mask.size();
                if (!is_brick) return visit(corner, edge);
                const std::uint64_t* mask = &bricks.mask[8 * std::size_t(node.value)];
                const double voxel = edge / brick_edge;
                for (int i = 0; i < brick_voxels; ++i)
                  if ((mask[i >> 6] >> (i & 63) & 1) != 0)
                    visit(corner + Vec3d{double(i & 7), double(i >> 3 & 7), double(i >> 6)} * voxel, voxel);
              });
  return true;
}

template <class Visit>
void for_each_occupied_box(const PagedScene& scene, const PageSource& pages, const Visit& visit) {
  std::optional<OverviewLevels> levels;
  if (scene.totals().cells > max_cells_read_below_root) levels = overview_levels(scene);
  if (!levels || !visit_root(scene, levels->root, pages, visit)) visit_cells(scene, pages, visit);
}

Vec3d middle_of(const PagedScene& scene, const PageSource& pages) {
  Vec3d low = Vec3d::all(HUGE_VAL), high = Vec3d::all(-HUGE_VAL);
  for_each_occupied_box(scene, pages, [&](const Vec3d& corner, double edge) {
    low = min_by_axis(low, corner);
    high = max_by_axis(high, corner + Vec3d::all(edge));
  });
  return (low + high) * 0.5;
}

/// Two opposite sides of the frustum, moved outwards until all boxes lie between them. `low` and `high` are the
/// positions along `across` at which the sides intersect the plane of depth 0.
struct FrustumSides {
  Vec3d across;  ///< unit, from the low to the high side
  Vec3d low_normal, high_normal;
  double tan;
  double low = HUGE_VAL, high = -HUGE_VAL;

  FrustumSides(const Vec3d& unit_across, const Vec3d& forward, double tangent)
      : across(unit_across),
        low_normal(unit_across + forward * tangent),
        high_normal(unit_across - forward * tangent),
        tan(tangent) {}

  void include(const Vec3d& centre, double half_edge) {
    const auto reach = [&](const Vec3d& n) {
      return half_edge * (std::fabs(n[0]) + std::fabs(n[1]) + std::fabs(n[2]));
    };
    low = std::min(low, dot(centre, low_normal) - reach(low_normal));
    high = std::max(high, dot(centre, high_normal) + reach(high_normal));
  }
};

/// Returns the nearest eye from which the whole scene is visible. If `target` is set, it is in the middle of the image.
Vec3d framing_eye(const PagedScene& scene, const PageSource& pages, const std::optional<Vec3d>& target,
                  const Axes& axes, double tan_x, double tan_y) {
  constexpr double margin = 0.96;
  FrustumSides sides[2] = {{axes.right, axes.forward, tan_x * margin}, {axes.up, axes.forward, tan_y * margin}};
  for_each_occupied_box(scene, pages, [&](const Vec3d& corner, double edge) {
    for (FrustumSides& s : sides) s.include(corner + Vec3d::all(edge / 2), edge / 2);
  });
  double depth = HUGE_VAL;
  Vec3d eye{};
  for (const FrustumSides& s : sides) {
    const double middle = target ? dot(*target, s.across) : (s.low + s.high) / 2;
    depth = std::min({depth, (s.low - middle) / s.tan, (middle - s.high) / s.tan});
    eye = eye + s.across * middle;
  }
  return eye + axes.forward * depth;
}

void set(double out[3], const Vec3d& v) { std::copy(v.begin(), v.end(), out); }

kernels::CastClip cast_clip(const Clip& clip, const SceneHeader& scene) {
  kernels::CastClip out;
  if (clip.box_m) {
    set(out.min, to_voxels((*clip.box_m)[0], scene, "clip_box"));
    set(out.max, to_voxels((*clip.box_m)[1], scene, "clip_box"));
    for (int a = 0; a < 3; ++a)
      if (!(out.min[a] < out.max[a])) throw UsageError("clip_box", "expected the lowest corner first");
  }
  if (clip.plane) {
    const Vec3d towards{clip.plane->towards.x, clip.plane->towards.y, clip.plane->towards.z};
    if (!std::isfinite(length(towards)) || !(length(towards) > 0))
      throw UsageError("clip_plane", "expected a finite direction other than 0,0,0");
    set(out.normal, unit(towards));
    out.offset = dot(unit(towards), to_voxels(clip.plane->through_m, scene, "clip_plane"));
  }
  return out;
}

}  // namespace

void check_picture_size(const CameraOptions& o) {
  if (o.width < 1 || o.height < 1 || o.width > max_image_edge || o.height > max_image_edge ||
      std::int64_t(o.width) * o.height > max_pixels)
    throw UsageError("size", std::to_string(o.width) + "x" + std::to_string(o.height) +
                                 " is not an image size; expected 1 to 32768 per side and at most 2^28 pixels");
}

void check_pixel_error(double pixel_error) {
  if (!(pixel_error >= finest_pixel_error && pixel_error <= coarsest_pixel_error))
    throw UsageError("pixel_error", "expected 2^-16 to 2^16 pixels");
}

HeightRange occupied_heights(const PagedScene& scene, const PageSource& pages) {
  HeightRange range{HUGE_VAL, -HUGE_VAL};
  for_each_occupied_box(scene, pages, [&](const Vec3d& corner, double edge) {
    range.low = std::min(range.low, corner[2]);
    range.high = std::max(range.high, corner[2] + edge);
  });
  return range.low < range.high ? range : HeightRange{};
}

kernels::CastCamera make_camera(const CameraOptions& options, const PagedScene& scene, const PageSource& pages) {
  check_options(options);
  const double tan_y = std::tan(options.fovy_deg * (std::numbers::pi / 360));
  const double tan_x = tan_y * options.width / options.height;
  std::optional<Vec3d> target, eye;
  if (options.target_m) target = to_voxels(*options.target_m, scene.header(), "target_m");
  if (options.eye_m) eye = to_voxels(*options.eye_m, scene.header(), "eye_m");
  Vec3d forward = unit(oblique_view);
  if (!eye) {
    eye = framing_eye(scene, pages, target, look(forward, options.up), tan_x, tan_y);
  } else {
    if (!target) target = middle_of(scene, pages);
    if (*target == *eye) throw UsageError("target_m", "the same place as `eye_m`; there is no direction to look");
    forward = unit(*target - *eye);
  }
  const Axes axes = look(forward, options.up);

  kernels::CastCamera camera;
  camera.clip = cast_clip(options.clip, scene.header());
  set(camera.eye, *eye);
  set(camera.forward, axes.forward);
  set(camera.right, axes.right * tan_x);
  set(camera.up, axes.up * tan_y);
  camera.width = options.width;
  camera.height = options.height;
  camera.lod1_depth = 2 / options.pixel_error * options.height / (2 * tan_y);
  return camera;
}

}  // namespace gigabake
