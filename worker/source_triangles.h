/// All triangles of a source at once, placed in a bake's lattice but neither snapped nor filtered, with the materials
/// and texels that a bake gives them.
///
/// Space   Lod-0 voxels of the lattice. Positions go there in double, and to float only as distances from `middle`.
#pragma once

#include <array>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "format/source/source.h"
#include "lattice/parameters.h"
#include "worker/cell_loader.h"

namespace gigabake {

struct TriangleBox {
  std::array<double, 3> min{}, max{};
};

struct TriangleName {
  std::uint32_t part = 0, triangle = 0;
  friend auto operator<=>(const TriangleName&, const TriangleName&) = default;
};

/// Where a ray meets a triangle: barycentric weights of its second and third vertex.
struct TrianglePoint {
  std::uint32_t part = 0, triangle = 0;
  float second = 0, third = 0;
};

class SourceTriangles {
 public:
  /// Cost    Memory for every tile and image of the source at once.
  /// Errors  InputError: a tile or image that cannot be read; no triangles.
  SourceTriangles(const SceneSources& sources, const BakeParameters& lattice, int threads);

  std::size_t parts() const { return cell_.parts.size(); }
  /// 3 per triangle, each < the vertex count.
  Span<const std::uint32_t> indices(std::size_t part) const { return cell_.parts[part].index; }
  /// 3 per vertex, relative to middle(); not finite where the source's are not.
  std::vector<float> positions(std::size_t part) const;
  /// Of one triangle, in double, in the order of its indices.
  std::array<std::array<double, 3>, 3> corners(std::size_t part, std::size_t triangle) const;
  /// Texels of its image that lie in it; 0: it has none.
  double texels(std::size_t part, std::size_t triangle) const;
  /// Whether the part is an instance that is a mirror image: outside is then where the left hand points.
  bool is_mirrored(std::size_t part) const;
  /// Towards its outside, of length 1: by the winding as the instance shows it. All 0 where it has no area.
  std::array<double, 3> outside(std::size_t part, std::size_t triangle) const;
  const TriangleBox& box() const { return box_; }
  const std::array<double, 3>& middle() const { return middle_; }

  /// Linear, premultiplied: the bilinear texel, the vertex colours and the base colour at the point; alpha as the
  /// material's mode makes it. Both sides look alike, as they do to a bake.
  std::array<float, 4> colour(const TrianglePoint& at) const;

 private:
  std::array<double, 3> to_lattice(const kernels::PartView& part, std::size_t vertex) const;
  void measure();

  LoadedCell cell_;
  double voxel_size_m_;
  std::array<double, 3> lattice_origin_m_;
  TriangleBox box_;
  std::array<double, 3> middle_{};
};

}  // namespace gigabake
