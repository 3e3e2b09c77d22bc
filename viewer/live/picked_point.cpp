#include "viewer/live/picked_point.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

#include "core/math/georeference.h"
#include "kernels/marching/cast_line.h"
#include "kernels/marching/pixel.h"

namespace gigabake {
namespace {

int pixel_at(double share, int count) { return std::clamp(int(share * count), 0, count - 1); }

}  // namespace

std::optional<PickedPoint> picked_point(const Picture& picture, const PictureRays& rays, double right, double down) {
  const int x = pixel_at(right, picture.width), y = pixel_at(down, picture.height);
  const float distance = picture.depth[std::size_t(y) * std::size_t(picture.width) + std::size_t(x)];
  if (!(distance > 0 && distance < kernels::CastRay::no_depth)) return {};  // 0: not rendered yet
  const kernels::CastLine line = kernels::line_of_sight({}, rays.camera, x, y);
  const Vec3d m = Vec3d::by_axis([&](int axis) {
    return rays.lattice_origin_m[axis] +
           (line.origin[axis] + line.direction[axis] * double(distance)) * rays.voxel_size_m;
  });
  PickedPoint out{{m[0], m[1], m[2]}, double(distance) * rays.voxel_size_m, {}};
  if (rays.origin) out.place = geodetic_of(ecef_from_enu(*rays.origin)(out.at_m));
  return out;
}

std::string place_text(const PickedPoint& point) {
  const Point<Scene>& at = point.at_m;
  const std::string there = point.place ? fmt::format("lat {:.7f}° lon {:.7f}° {:.2f} m", point.place->latitude_deg,
                                                      point.place->longitude_deg, point.place->height_m)
                                        : fmt::format("{:.2f} {:.2f} {:.2f}", at.x, at.y, at.z);
  return there + fmt::format(", {:.2f} m away", point.distance_m);
}

std::string distance_text(const PickedPoint& from, const PickedPoint& to) {
  const double across = std::hypot(to.at_m.x - from.at_m.x, to.at_m.y - from.at_m.y), up = to.at_m.z - from.at_m.z;
  return fmt::format("{:.2f} m: {:.2f} m horizontal, {:.2f} m vertical", std::hypot(across, up), across, up);
}

}  // namespace gigabake
