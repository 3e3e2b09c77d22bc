/// Origins for a mesh with large coordinates. Positions are stored as floats relative to an origin, to limit rounding.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <span>
#include <vector>

#include "core/math/frames.h"
#include "format/source/mesh.h"
#include "format/source/source.h"

namespace gigabake {

/// The max number of vertices, read from the beginning of a file, that determine the location of a mesh on earth.
inline constexpr std::size_t max_first_vertices = 64;

/// The bounding box of finite positions.
class PositionExtent {
 public:
  void add(const std::array<double, 3>& position);
  void add(const PositionExtent& other);

  /// Returns the centre in whole metres if the absolute value of a coordinate exceeds 10 km, else zero.
  std::array<double, 3> origin() const;
  /// Returns the distance between adjacent floats at the coordinate of max absolute value, in the unit of the file;
  /// 0 if all coordinates are zero.
  float float_step() const;

 private:
  double max_magnitude() const;

  std::array<double, 3> low_{0, 0, 0}, high_{0, 0, 0};
  bool is_empty_ = true;
};

/// The origin of vertices that are near each other. Positions are rounded to floats after the origin is subtracted, so
/// projected coordinates keep a precision of millimetres.
class MeshOrigin {
 public:
  MeshOrigin(const TileRef& tile, const PositionExtent& extent);

  bool is_moved() const { return at_ != std::array<double, 3>{0, 0, 0}; }
  /// Returns PositionExtent::float_step() of the vertices.
  float float_step() const { return float_step_; }
  /// Returns the transform that places the mesh, including the translation by the origin.
  const Affine<Scene, Local>& scene_from_local() const { return scene_from_local_; }
  void add_vertex(const std::array<double, 3>& position, Primitive& to) const;

 private:
  std::array<double, 3> at_;
  float float_step_;
  Affine<Scene, Local> scene_from_local_;
};

/// The origins of a mesh, one per group of vertices that is far from all other groups. An outlier therefore does not
/// reduce the precision of other vertices. Vertices belong to one group if adjacent cells of 131 km connect them.
/// Exact   The origins do not depend on the order in which vertices are added.
class MeshOrigins {
 public:
  explicit MeshOrigins(const TileRef& tile) : tile_(tile) {}

  /// Adds a vertex. Ignores a vertex that is not finite.
  void add(const std::array<double, 3>& position);
  /// Computes the groups and origins; called once, after all vertices have been added.
  void finish();

  std::size_t groups() const { return origins_.size(); }
  /// Returns the group of an added vertex; 0 if the vertex was not added or is not finite.
  std::size_t group_of(const std::array<double, 3>& position) const;
  const MeshOrigin& origin(std::size_t group) const { return origins_[group]; }

  using Take = std::function<void(Primitive&&, const MeshOrigin&)>;
  /// Fills in the positions of a primitive and passes the primitive to `take`. Vertex v gets the position
  /// positions[position_of[v]]. All other lists of the primitive must be complete.
  /// If its triangles belong to several groups, `take` is called once per group with the triangles of the group. The
  /// first corner of a triangle determines its group.
  void place(Primitive&& primitive, std::span<const std::uint32_t> position_of,
             std::span<const std::array<double, 3>> positions, const Take& take) const;

 private:
  using Cell = std::array<std::int64_t, 3>;
  static Cell cell_of(const std::array<double, 3>& position);
  void join_cells();

  const TileRef& tile_;
  std::map<Cell, PositionExtent> extents_;
  PositionExtent* last_extent_ = nullptr;  ///< the extent of last_cell_
  Cell last_cell_{};
  bool is_one_group_ = false;  ///< true if there were more than max_cells cells
  std::map<Cell, std::size_t> group_;
  std::vector<MeshOrigin> origins_;  ///< not empty after finish()
};

}  // namespace gigabake
