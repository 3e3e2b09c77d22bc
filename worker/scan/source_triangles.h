/// All triangles of a source in the lattice of a bake, with the bake's materials and textures. They are neither snapped
/// nor filtered.
///
/// Space   Coordinates are in lod-0 voxels of the lattice. Positions are transformed in double; float is used only for
///         offsets from `middle`.
#pragma once

#include <array>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "core/math/vec3.h"
#include "core/octree/parameters.h"
#include "format/source/source.h"
#include "worker/pipeline/cell_loader.h"

namespace gigabake {

/// A closed box.
struct TriangleBox {
  Vec3d min{}, max{};
  Vec3d centre() const { return (min + max) / 2; }
};

struct TriangleName {
  std::uint32_t part = 0, triangle = 0;
  friend auto operator<=>(const TriangleName&, const TriangleName&) = default;
};

/// An intersection of a ray and a triangle, with the barycentric weights of the triangle's second and third vertex.
struct TrianglePoint {
  std::uint32_t part = 0, triangle = 0;
  float second = 0, third = 0;
};

class SourceTriangles {
 public:
  /// Loads the whole source.
  /// Cost    Memory for every tile and image of the source at once.
  /// Errors  InputError if a tile or image cannot be read, or if the source has no triangles.
  SourceTriangles(const SceneSources& sources, const BakeParameters& lattice, int threads);

  /// Returns the same parts with other triangles of their vertices. `indices` has one entry per part and is borrowed.
  /// box() and middle() do not change. Copies share the source's data.
  SourceTriangles with_indices(const std::vector<Span<const std::uint32_t>>& indices) const;

  std::size_t parts() const { return parts_.size(); }
  /// Returns the vertices of a part, in the coordinates of its tile, and the attributes that colour() interpolates.
  const kernels::PartView& part(std::size_t part) const { return parts_[part]; }
  /// Returns 3 indices per triangle, each < the vertex count.
  Span<const std::uint32_t> indices(std::size_t part) const { return parts_[part].index; }
  /// Returns 3 coordinates per vertex, relative to middle(); not finite if the source's coordinates are not.
  std::vector<float> positions(std::size_t part) const;
  /// Returns the corners of one triangle, in double, in the order of its indices.
  std::array<Vec3d, 3> corners(std::size_t part, std::size_t triangle) const;
  /// Returns the number of texels that the triangle covers in its image; 0 if it has no image.
  double texels(std::size_t part, std::size_t triangle) const;
  /// Returns true if the part's instance transform is a reflection: the winding then follows the left-hand rule.
  bool is_mirrored(std::size_t part) const;
  /// Returns the outward unit normal, as defined by the winding and is_mirrored(); 0 if the triangle has no area.
  Vec3d outside(std::size_t part, std::size_t triangle) const;
  const TriangleBox& box() const { return box_; }
  const Vec3d& middle() const { return middle_; }

  /// Returns the linear, premultiplied colour at a point. It is the product of the bilinear (or nearest) texel, vertex
  /// colour and base colour, with alpha by the material's mode. Both sides have the same colour, as in a bake.
  std::array<float, 4> colour(const TrianglePoint& at) const;

 private:
  Vec3d to_lattice(const kernels::PartView& part, std::size_t vertex) const;
  void measure();

  std::shared_ptr<const LoadedCell> cell_;
  std::vector<kernels::PartView> parts_;
  double voxel_size_m_;
  Vec3d lattice_origin_m_;
  TriangleBox box_;
  Vec3d middle_{};
};

}  // namespace gigabake
