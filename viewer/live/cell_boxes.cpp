#include "viewer/live/cell_boxes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <utility>
#include <vector>

#include "core/base/pluralize.h"
#include "kernels/marching/cast_line.h"
#include "kernels/marching/cast_ray.h"
#include "kernels/marching/pixel.h"

namespace gigabake {
namespace {

/// Opacity of an edge behind a surface.
constexpr double faint = 0.25;
/// The distance by which an edge may lie behind the surface and still counts as visible, as a fraction.
constexpr double depth_tolerance = 1e-3;
constexpr double near_depth = 1e-3;  ///< voxels

using Rgb = std::array<std::uint8_t, 3>;

Rgb colour_of(CellState state) {
  if (state == CellState::failed) return {255, 60, 60};
  return state == CellState::baking ? Rgb{255, 190, 40} : Rgb{90, 100, 115};
}

/// A point in the camera's frame: position in the image from -1 to 1 times the depth, and the depth in voxels.
struct CameraPoint {
  double x = 0, y = 0, depth = 0;
};

CameraPoint between(const CameraPoint& a, const CameraPoint& b, double t) {
  return {a.x + (b.x - a.x) * t, a.y + (b.y - a.y) * t, a.depth + (b.depth - a.depth) * t};
}

class BoxPainter {
 public:
  BoxPainter(Picture& picture, const kernels::CastCamera& camera)
      : picture_(picture),
        camera_(camera),
        right_squared_(dot(camera.right, camera.right)),
        up_squared_(dot(camera.up, camera.up)) {}

  void paint(const CellBox& cell) { paint(cell.window, colour_of(cell.state), cell.state == CellState::failed); }

  void paint(const Box3i64& box, const Rgb& rgb, bool has_diagonals) {
    std::array<CameraPoint, 8> corners;
    for (unsigned c = 0; c < 8; ++c)
      corners[c] = in_camera(
          Vec3d::by_axis([&](int axis) { return double((c >> axis & 1) != 0 ? box.end[axis] : box.min[axis]); }));
    for (unsigned c = 0; c < 8; ++c)
      for (unsigned axis = 1; axis < 8; axis *= 2)
        if ((c & axis) == 0) line(corners[c], corners[c | axis], rgb);
    if (!has_diagonals) return;
    for (unsigned c = 0; c < 4; ++c) line(corners[c], corners[7 - c], rgb);
  }

 private:
  CameraPoint in_camera(const Vec3d& voxels) const {
    const Vec3d v = voxels - camera_.eye;
    return {dot(v, camera_.right) / right_squared_, dot(v, camera_.up) / up_squared_, dot(v, camera_.forward)};
  }

  /// Shortens the line from `a` to `b` to the part where `f` is not negative. Returns false if there is none.
  template <class F>
  static bool clip(CameraPoint& a, CameraPoint& b, const F& f) {
    const double at_a = f(a), at_b = f(b);
    if (at_a < 0 && at_b < 0) return false;
    if (at_a < 0)
      a = between(a, b, at_a / (at_a - at_b));
    else if (at_b < 0)
      b = between(a, b, at_a / (at_a - at_b));
    return true;
  }

  void line(CameraPoint a, CameraPoint b, const Rgb& rgb) {
    const bool is_visible = clip(a, b, [](const CameraPoint& p) { return p.depth - near_depth; }) &&
                            clip(a, b, [](const CameraPoint& p) { return p.depth - p.x; }) &&
                            clip(a, b, [](const CameraPoint& p) { return p.depth + p.x; }) &&
                            clip(a, b, [](const CameraPoint& p) { return p.depth - p.y; }) &&
                            clip(a, b, [](const CameraPoint& p) { return p.depth + p.y; });
    if (!is_visible) return;
    const double w = picture_.width / 2.0, h = picture_.height / 2.0;
    const double across = std::fabs(a.x / a.depth - b.x / b.depth) * w,
                 down = std::fabs(a.y / a.depth - b.y / b.depth) * h;
    const int steps = std::max(1, int(std::ceil(std::max(across, down))));
    for (int i = 0; i <= steps; ++i) {
      const double share = double(i) / steps;  // of the line in the image
      const double inverse = (1 - share) / a.depth + share / b.depth;
      point((1 - share) * a.x / a.depth + share * b.x / b.depth, (1 - share) * a.y / a.depth + share * b.y / b.depth,
            1 / inverse, rgb);
    }
  }

  void point(double x, double y, double depth, const Rgb& rgb) {
    const int column = std::clamp(int((x + 1) / 2 * picture_.width), 0, picture_.width - 1);
    const int row = std::clamp(int((1 - y) / 2 * picture_.height), 0, picture_.height - 1);
    const std::size_t pixel = std::size_t(row) * std::size_t(picture_.width) + std::size_t(column);
    const double distance = depth * std::sqrt(1 + x * x * right_squared_ + y * y * up_squared_);
    const float surface = picture_.depth[pixel];
    const bool is_hidden = surface > 0 && distance > double(surface) * (1 + depth_tolerance);
    blend(&picture_.rgba[4 * pixel], rgb, is_hidden ? faint : 1);
  }

  static void blend(std::uint8_t* rgba, const Rgb& rgb, double opacity) {
    for (std::size_t c = 0; c < 3; ++c) rgba[c] = std::uint8_t(std::lround(rgba[c] + (rgb[c] - rgba[c]) * opacity));
    rgba[3] = std::uint8_t(std::lround(rgba[3] + (255 - rgba[3]) * opacity));
  }

  Picture& picture_;
  const kernels::CastCamera& camera_;
  const double right_squared_, up_squared_;
};

double squared_distance(const CellBox& cell, const Vec3d& eye) {
  const Vec3d v = (Vec3d(cell.window.min) + Vec3d(cell.window.end)) * 0.5 - eye;
  return dot(v, v);
}

/// Returns the cells to draw: waiting cells first, so that the others cover their edges.
std::vector<CellBox> cells_to_draw(std::span<const CellBox> cells, const Vec3d& eye) {
  std::vector<std::pair<std::pair<bool, double>, const CellBox*>> ranked;
  for (const CellBox& cell : cells)
    if (cell.state != CellState::done)
      ranked.push_back({{cell.state == CellState::waiting, squared_distance(cell, eye)}, &cell});
  const auto order = [](const auto& a, const auto& b) { return a.first < b.first; };
  if (ranked.size() > max_boxes_drawn) {
    std::nth_element(ranked.begin(), ranked.begin() + max_boxes_drawn, ranked.end(), order);
    ranked.resize(max_boxes_drawn);
  }
  std::sort(ranked.begin(), ranked.end(), order);
  std::vector<CellBox> found;
  for (auto it = ranked.rbegin(); it != ranked.rend(); ++it) found.push_back(*it->second);
  return found;
}

/// Returns the distances at which a ray enters and leaves a box; nullopt if it misses the box.
std::optional<std::pair<double, double>> crossing(const kernels::CastLine& ray, const Box3i64& box) {
  double from = 0, to = HUGE_VAL;
  for (int axis = 0; axis < 3; ++axis) {
    const double origin = ray.origin[axis], direction = ray.direction[axis];
    double low = (double(box.min[axis]) - origin) / direction, high = (double(box.end[axis]) - origin) / direction;
    if (direction == 0) {
      if (origin < double(box.min[axis]) || origin >= double(box.end[axis])) return {};
      continue;
    }
    if (low > high) std::swap(low, high);
    from = std::max(from, low);
    to = std::min(to, high);
  }
  if (!(from < to)) return {};
  return std::pair(from, to);
}

}  // namespace

void draw_boxes(Picture& picture, const kernels::CastCamera& camera, std::span<const CellBox> cells) {
  BoxPainter painter(picture, camera);
  for (const CellBox& cell : cells_to_draw(cells, camera.eye)) painter.paint(cell);
}

void draw_edges(Picture& picture, const kernels::CastCamera& camera, const Box3i64& box, const Rgb& rgb) {
  BoxPainter(picture, camera).paint(box, rgb, false);
}

std::optional<std::uint32_t> picked_cell(const Picture& picture, const kernels::CastCamera& camera,
                                         std::span<const CellBox> cells, double right, double down) {
  const int x = std::clamp(int(right * picture.width), 0, picture.width - 1);
  const int y = std::clamp(int(down * picture.height), 0, picture.height - 1);
  const float depth = picture.depth[std::size_t(y) * std::size_t(picture.width) + std::size_t(x)];
  const bool has_surface = depth > 0 && depth < kernels::CastRay::no_depth;
  const double surface = has_surface ? double(depth) : HUGE_VAL;
  const kernels::CastLine ray = kernels::line_of_sight({}, camera, x, y);
  std::optional<std::uint32_t> open, solid;
  double nearest = HUGE_VAL;
  for (std::uint32_t i = 0; i < cells.size(); ++i) {
    const auto crossed = crossing(ray, cells[i].window);
    if (!crossed) continue;
    if (cells[i].state == CellState::done) {
      if (crossed->first <= surface && surface <= crossed->second) solid = i;
    } else if (crossed->first < std::min(nearest, surface)) {
      nearest = crossed->first;
      open = i;
    }
  }
  return open ? open : solid;
}

std::string cell_text(const CellFacts& facts) {
  constexpr std::size_t max_tiles = 8;
  std::string text = fmt::format("{}: {}, {} triangles, {:.1f} % of the cost", facts.name, name_of(facts.state),
                                 facts.triangles, 100 * facts.cost);
  if (facts.seconds > 0) text += fmt::format(", {:.1f} s, {} voxels", facts.seconds, facts.voxels);
  const std::size_t shown = std::min(facts.tiles.size(), max_tiles);
  text += ", " + pluralize(facts.tiles.size(), "tile");
  for (std::size_t i = 0; i < shown; ++i) text += (i == 0 ? ": " : ", ") + facts.tiles[i];
  if (shown < facts.tiles.size()) text += ", …";
  return facts.error.empty() ? text : text + "; " + facts.error;
}

}  // namespace gigabake
