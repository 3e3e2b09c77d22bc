#include "worker/scan/source_triangles.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "core/base/error.h"
#include "kernels/body/tables.h"
#include "kernels/body/texture/nearest_texture.h"
#include "kernels/body/voxelize/surface.h"

namespace gigabake {
namespace {

/// Returns a job whose cell is so large that it contains the whole source.
CellJob everything(const SceneSources& sources) {
  CellJob job;
  constexpr std::int64_t reach = std::int64_t(1) << 31;
  job.lattice_min = {-reach, -reach, -reach};
  job.cell_voxels = std::numeric_limits<std::uint32_t>::max();
  job.tiles.resize(sources.tiles.size());
  std::iota(job.tiles.begin(), job.tiles.end(), 0u);
  return job;
}

struct Weights {
  double of[3];
  explicit Weights(const TrianglePoint& at) : of{1.0 - at.second - at.third, at.second, at.third} {}
};

kernels::Rgba16 factor_at(const kernels::PartView& part, const kernels::MaterialView& material,
                          const std::uint32_t vertex[3], const Weights& weights) {
  kernels::Rgba16 factor;
  for (std::size_t c = 0; c < 4; ++c) {
    factor.c[c] = material.base_rgba[c];
    if (part.rgba.empty()) continue;
    double sum = 0.5;
    for (int k = 0; k < 3; ++k) sum += weights.of[k] * part.rgba[4 * std::size_t(vertex[k]) + c];
    factor.c[c] = kernels::scale16(factor.c[c], std::uint32_t(std::clamp(sum, 0.0, 65535.0)));
  }
  return factor;
}

kernels::Rgba16 texel_at(const kernels::PartView& part, const kernels::MaterialView& material,
                         const kernels::TextureView& texture, const std::uint32_t vertex[3], const Weights& weights) {
  float uv[6];
  for (int i = 0; i < 6; ++i) uv[i] = part.uv.empty() ? 0 : part.uv[2 * std::size_t(vertex[i / 2]) + i % 2];
  double s = 0, t = 0;
  for (int k = 0; k < 3 && kernels::usable_uv(uv); ++k) {
    s += weights.of[k] * uv[2 * k];
    t += weights.of[k] * uv[2 * k + 1];
  }
  const kernels::Tables tables = kernels::TableStore::host().view();
  if (material.nearest)
    return kernels::nearest_texel(texture, material.wrap_s, material.wrap_t, s, t, tables.linear_from_srgb);
  return kernels::sample_level<false>(texture, material, 0, kernels::fraction_of(s, material.wrap_s),
                                      kernels::fraction_of(t, material.wrap_t), tables);
}

}  // namespace

SourceTriangles::SourceTriangles(const SceneSources& sources, const BakeParameters& lattice, int threads)
    : cell_(std::make_shared<LoadedCell>(CellLoader(sources, lattice, 0, threads).load(everything(sources)))),
      parts_(cell_->parts),
      voxel_size_m_(lattice.voxel_size_m),
      lattice_origin_m_(lattice.lattice_origin_m) {
  measure();
  if (!(box_.min[0] <= box_.max[0])) throw InputError(sources.root, "", "has no triangles to show");
}

SourceTriangles SourceTriangles::with_indices(const std::vector<Span<const std::uint32_t>>& indices) const {
  SourceTriangles other = *this;
  for (std::size_t part = 0; part < parts(); ++part) other.parts_[part].index = indices[part];
  return other;
}

Vec3d SourceTriangles::to_lattice(const kernels::PartView& part, std::size_t vertex) const {
  const Vec3d local = Vec3d::from(part.position.data + 3 * vertex);
  const Vec3d p_scene_m = Vec3d::by_axis([&](int row) {
    const double* m = part.scene_from_local + 4 * row;
    return dot(Vec3d::from(m), local) + m[3];
  });
  return (p_scene_m - lattice_origin_m_) / voxel_size_m_;
}

void SourceTriangles::measure() {
  constexpr double infinite = std::numeric_limits<double>::infinity();
  box_ = {Vec3d::all(infinite), Vec3d::all(-infinite)};
  for (const kernels::PartView& part : parts_)
    for (std::size_t i = 0; i < part.index.size; ++i) {
      const Vec3d p = to_lattice(part, part.index[i]);
      if (!std::isfinite(p[0]) || !std::isfinite(p[1]) || !std::isfinite(p[2])) continue;
      box_ = {min_by_axis(box_.min, p), max_by_axis(box_.max, p)};
    }
  const Vec3d centre = box_.centre();
  middle_ = {std::floor(centre[0]), std::floor(centre[1]), std::floor(centre[2])};
}

std::array<Vec3d, 3> SourceTriangles::corners(std::size_t part, std::size_t triangle) const {
  const kernels::PartView& view = parts_[part];
  const auto corner = [&](std::size_t k) { return to_lattice(view, view.index[3 * triangle + k]); };
  return {corner(0), corner(1), corner(2)};
}

double SourceTriangles::texels(std::size_t part, std::size_t triangle) const {
  const kernels::PartView& view = parts_[part];
  const std::int32_t texture = cell_->materials[view.material].texture;
  if (texture < 0 || view.uv.empty()) return 0;
  const auto uv = [&](std::size_t corner, std::size_t c) {
    return double(view.uv[2 * std::size_t(view.index[3 * triangle + corner]) + c]);
  };
  const double area = (uv(1, 0) - uv(0, 0)) * (uv(2, 1) - uv(0, 1)) - (uv(2, 0) - uv(0, 0)) * (uv(1, 1) - uv(0, 1));
  const kernels::TextureView& image = cell_->texture_views[std::size_t(texture)];
  const double texels = std::fabs(area) / 2 * image.width * image.height;
  return std::isfinite(texels) ? texels : 0;
}

bool SourceTriangles::is_mirrored(std::size_t part) const {
  const double* m = parts_[part].scene_from_local;
  return m[0] * (m[5] * m[10] - m[6] * m[9]) - m[1] * (m[4] * m[10] - m[6] * m[8]) +
             m[2] * (m[4] * m[9] - m[5] * m[8]) <
         0;
}

Vec3d SourceTriangles::outside(std::size_t part, std::size_t triangle) const {
  const auto p = corners(part, triangle);
  const Vec3d n = cross(p[1] - p[0], p[2] - p[0]);
  const double length = std::hypot(n[0], n[1], n[2]) * (is_mirrored(part) ? -1 : 1);
  if (!(std::fabs(length) > 0)) return {};
  return n / length;
}

std::vector<float> SourceTriangles::positions(std::size_t part) const {
  const kernels::PartView& view = parts_[part];
  std::vector<float> out;
  out.reserve(view.position.size);
  for (std::size_t v = 0; v < view.position.size / 3; ++v) {
    const auto p = Vec3<float>(to_lattice(view, v) - middle_);
    out.insert(out.end(), p.begin(), p.end());
  }
  return out;
}

std::array<float, 4> SourceTriangles::colour(const TrianglePoint& at) const {
  const kernels::PartView& part = parts_[at.part];
  const kernels::MaterialView& material = cell_->materials[part.material];
  const std::uint32_t* vertex = part.index.data + 3 * std::size_t(at.triangle);
  const Weights weights(at);
  kernels::Rgba16 texel{{65535, 65535, 65535, 65535}};
  if (material.texture >= 0)
    texel = texel_at(part, material, cell_->texture_views[std::size_t(material.texture)], vertex, weights);
  const kernels::Rgba16 rgba = kernels::apply_material(material, factor_at(part, material, vertex, weights), texel);
  std::array<float, 4> out;
  for (std::size_t c = 0; c < 4; ++c) out[c] = float(rgba.c[c]) / 65535;
  return out;
}

}  // namespace gigabake
