#include "worker/scan/texel_size.h"

#include <array>
#include <cmath>
#include <map>

#include "format/source/image/image_size.h"
#include "worker/pipeline/lattice.h"
#include "worker/pipeline/materials.h"

namespace gigabake {
namespace {

constexpr std::size_t max_triangles = std::size_t(1) << 22;

using TriangleCorners = std::array<Vec3d, 3>;

TriangleCorners corners_of(const Primitive& primitive, const Instance& instance, const std::uint32_t* index) {
  const auto m = row_major(instance.scene_from_local);
  TriangleCorners corners{};
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec3d local = Vec3d::from(primitive.position.data() + 3 * std::size_t(index[i]));
    corners[i] = Vec3d::by_axis([&](std::size_t row) { return dot(Vec3d::from(&m[4 * row]), local); });
  }
  return corners;
}

double area_m2(const TriangleCorners& c) { return length(cross(c[1] - c[0], c[2] - c[0])) / 2; }

/// Returns the triangle's area as a fraction of the whole image.
double area_in_texture(const Primitive& primitive, const std::uint32_t* index) {
  const float *p = &primitive.uv[2 * std::size_t(index[0])], *q = &primitive.uv[2 * std::size_t(index[1])],
              *r = &primitive.uv[2 * std::size_t(index[2])];
  const double ax = double(q[0]) - double(p[0]), ay = double(q[1]) - double(p[1]);
  const double bx = double(r[0]) - double(p[0]), by = double(r[1]) - double(p[1]);
  return std::fabs(ax * by - ay * bx) / 2;
}

TexelSize size_of(const Primitive& primitive, const Instance& instance, double texels) {
  TexelSize sum;
  for (std::size_t t = 0; t + 2 < primitive.index.size(); t += 3) {
    const std::uint32_t* index = &primitive.index[t];
    const double area = area_m2(corners_of(primitive, instance, index));
    const double in_texture = area_in_texture(primitive, index) * texels;
    if (!(area > 0 && in_texture > 0 && std::isfinite(area) && std::isfinite(in_texture))) continue;
    sum.area_m2 += area;
    sum.log_size_area += area * std::log(area / in_texture) / 2;
  }
  return sum;
}

}  // namespace

void TexelSize::add(const TexelSize& other) {
  area_m2 += other.area_m2;
  log_size_area += other.log_size_area;
}

double TexelSize::mean_m() const { return area_m2 > 0 ? std::exp(log_size_area / area_m2) : 0; }

TexelSize texel_size(const TileMesh& mesh) {
  std::map<int, double> texels;  // key: index of the image
  TexelSize sum;
  std::size_t triangles = 0;
  for (const Instance& instance : mesh.instances) {
    const Primitive& primitive = mesh.primitives[std::size_t(instance.primitive)];
    triangles += primitive.index.size() / 3;
    if (triangles > max_triangles) break;
    const int image = shaded_material(mesh.materials[std::size_t(primitive.material)]).image;
    if (image < 0 || primitive.uv.empty()) continue;
    if (texels.find(image) == texels.end()) {
      const ImageSize size = image_size(mesh.images[std::size_t(image)]);
      texels[image] = double(size.width) * double(size.height);
    }
    sum.add(size_of(primitive, instance, texels[image]));
  }
  return sum;
}

}  // namespace gigabake
