#include "bench/accuracy/surface_points.h"

#include <cmath>

#include "bench/accuracy/clipped_triangle.h"
#include "bench/schedule_model.h"

namespace gigabake::bench {
namespace {

/// Returns the area; 0 if it is not finite, so that no point is sampled there.
double area_of(const Corners& triangle) {
  const double area = length(normal_of(triangle)) / 2;
  return std::isfinite(area) ? area : 0;
}

template <class Visit>
void for_each_triangle(const SourceTriangles& source, const Visit& visit) {
  for (std::uint32_t part = 0; part < source.parts(); ++part)
    for (std::uint32_t t = 0; t < source.indices(part).size / 3; ++t) {
      const Corners corners = source.corners(part, t);
      visit(TriangleName{part, t}, corners, area_of(corners));
    }
}

}  // namespace

std::vector<Vec3d> surface_points(const SourceTriangles& source, std::uint64_t maximum, std::uint64_t seed) {
  double area = 0;
  for_each_triangle(source, [&](TriangleName, const Corners&, double a) { area += a; });
  std::vector<Vec3d> points;
  double before = 0;
  std::uint64_t i = 0;
  const auto place = [&] { return (double(i) + uniform(seed, 3 * i)) / double(maximum) * area; };
  for_each_triangle(source, [&](TriangleName name, const Corners& corners, double a) {
    before += a;
    for (; i < maximum && place() < before; ++i) {
      const std::vector<ClippedCorner> whole{{corners[0], 0, 0}, {corners[1], 1, 0}, {corners[2], 0, 1}};
      const ClippedCorner p = point_in(whole, uniform(seed, 3 * i + 1), uniform(seed, 3 * i + 2));
      if (source.colour({name.part, name.triangle, float(p.second), float(p.third)})[3] > 0) points.push_back(p.at);
    }
  });
  return points;
}

}  // namespace gigabake::bench
