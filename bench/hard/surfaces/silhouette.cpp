#include "bench/hard/surfaces/silhouette.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

namespace gigabake::bench {
namespace {

using Point2 = std::array<double, 2>;
using Interval = std::pair<double, double>;
/// The parts of each horizontal line of an image that bodies cover, one interval per body; they may overlap.
using Lines = std::vector<std::vector<Interval>>;

Vec3d voxels(const std::optional<Point<Scene>>& p) { return {p->x, p->y, p->z}; }

/// Returns the interval of a horizontal line in the convex hull of the points. Every segment between two points lies in
/// the hull, and the borders of the hull are such segments.
Interval interval_at(const std::vector<Point2>& points, double y) {
  Interval interval{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
  for (std::size_t i = 0; i < points.size(); ++i)
    for (std::size_t j = 0; j < points.size(); ++j) {
      if (!(points[i][1] <= y && y < points[j][1])) continue;
      const double t = (y - points[i][1]) / (points[j][1] - points[i][1]);
      const double x = points[i][0] + t * (points[j][0] - points[i][0]);
      interval = {std::min(interval.first, x), std::max(interval.second, x)};
    }
  return interval;
}

Lines lines_of(const std::vector<ConvexBody>& bodies, const Pinhole& camera, double lines_per_pixel) {
  Lines lines(std::size_t(std::ceil(camera.height() * lines_per_pixel)));
  for (const ConvexBody& body : bodies) {
    std::vector<Point2> points;
    double top = std::numeric_limits<double>::infinity(), bottom = -top;
    for (const Vec3d& corner : body.corners) {
      points.push_back(camera.pixel_of(corner));
      top = std::min(top, points.back()[1]);
      bottom = std::max(bottom, points.back()[1]);
    }
    const auto first = std::size_t(std::max(0.0, std::floor(top * lines_per_pixel)));
    for (std::size_t i = first; i < lines.size() && double(i) < bottom * lines_per_pixel; ++i) {
      const Interval interval = interval_at(points, (double(i) + 0.5) / lines_per_pixel);
      if (interval.first < interval.second) lines[i].push_back(interval);
    }
  }
  return lines;
}

double length_of_union(std::vector<Interval> intervals, double width) {
  std::sort(intervals.begin(), intervals.end());
  double length = 0, end = 0;
  for (const auto& [from, to] : intervals) {
    length += std::max(0.0, std::min(to, width) - std::max(from, end));
    end = std::max(end, to);
  }
  return length;
}

}  // namespace

Pinhole::Pinhole(const CameraOptions& camera)
    : eye_(voxels(camera.eye_m)),
      forward_(unit_vector(voxels(camera.target_m) - eye_)),
      width_(camera.width),
      height_(camera.height),
      pixels_per_tangent_(camera.height / (2 * std::tan(camera.fovy_deg * std::numbers::pi / 360))) {
  const bool is_vertical = std::fabs(forward_[2]) > 1 - 1e-9;
  right_ = unit_vector(cross(forward_, is_vertical ? Vec3d{0, 1, 0} : Vec3d{0, 0, 1}));
  up_ = cross(right_, forward_);
}

std::array<double, 2> Pinhole::pixel_of(const Vec3d& p) const {
  const Vec3d d = p - eye_;
  const double scale = pixels_per_tangent_ / dot(d, forward_);
  return {0.5 * width_ + scale * dot(d, right_), 0.5 * height_ - scale * dot(d, up_)};
}

double silhouette_area(const std::vector<ConvexBody>& bodies, const Pinhole& camera, double lines_per_pixel) {
  double area = 0;
  for (std::vector<Interval>& line : lines_of(bodies, camera, lines_per_pixel))
    area += length_of_union(std::move(line), camera.width());
  return area / lines_per_pixel;
}

AlphaPicture silhouettes(const std::vector<ConvexBody>& bodies, const Pinhole& camera) {
  AlphaPicture picture{camera.width(), camera.height(), {}};
  for (const std::vector<Interval>& line : lines_of(bodies, camera, 1))
    for (int x = 0; x < camera.width(); ++x) {
      const auto is_inside = [&](const Interval& i) { return i.first <= x + 0.5 && x + 0.5 <= i.second; };
      picture.alpha.push_back(std::any_of(line.begin(), line.end(), is_inside) ? 1 : 0);
    }
  return picture;
}

}  // namespace gigabake::bench
