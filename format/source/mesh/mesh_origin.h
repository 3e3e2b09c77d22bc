/// Origins for a mesh whose coordinates floats would round: positions are stored as floats relative to them.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <span>
#include <vector>

#include "format/source/mesh.h"
#include "format/source/source.h"
#include "lattice/frames.h"

namespace gigabake {

/// So many vertices of a file's beginning are asked where on earth they stand.
inline constexpr std::size_t most_first_vertices = 64;

/// The bounds of finite positions.
class PositionExtent {
 public:
  void add(const std::array<double, 3>& position);
  void add(const PositionExtent& other);

  /// Returns the middle in whole metres if a position is beyond 10 km, else zero.
  std::array<double, 3> origin() const;
  /// Returns the distance between two neighbouring floats at the largest coordinate, in the file's own unit; 0 if every
  /// coordinate is zero.
  float float_step() const;

 private:
  double largest() const;

  std::array<double, 3> low_{0, 0, 0}, high_{0, 0, 0};
  bool is_empty_ = true;
};

/// The origin of vertices that are near each other. What is left after subtracting it is rounded to floats: projected
/// coordinates keep their millimetres.
class MeshOrigin {
 public:
  MeshOrigin(const TileRef& tile, const PositionExtent& extent);

  bool is_moved() const { return at_ != std::array<double, 3>{0, 0, 0}; }
  /// Returns PositionExtent::float_step() of its vertices.
  float float_step() const { return float_step_; }
  /// The mesh's place with this origin.
  const Affine<Scene, Local>& scene_from_local() const { return scene_from_local_; }
  void add_vertex(const std::array<double, 3>& position, Primitive& to) const;

 private:
  std::array<double, 3> at_;
  float float_step_;
  Affine<Scene, Local> scene_from_local_;
};

/// The origins of a mesh: one for each group of vertices that is far from all others, so that a lost vertex or triangle
/// does not cost the others their precision. Vertices are of one group if a chain of cells of 131 km connects them.
/// Exact  The same vertices give the same origins, in whatever order they are added.
class MeshOrigins {
 public:
  explicit MeshOrigins(const TileRef& tile) : tile_(tile) {}

  /// Takes in a vertex. One that is not finite is of no group.
  void add(const std::array<double, 3>& position);
  /// Ends the adding of vertices.
  void finish();

  std::size_t groups() const { return origins_.size(); }
  /// Returns the group of a vertex that was added; 0 if it was not, or is not finite.
  std::size_t group_of(const std::array<double, 3>& position) const;
  const MeshOrigin& origin(std::size_t group) const { return origins_[group]; }

  using Take = std::function<void(Primitive&&, const MeshOrigin&)>;
  /// Fills in the positions of a primitive that has all other lists, and hands it over: in one piece, or if its
  /// vertices are of several groups, in one piece per group of its triangles' first corners.
  void place(Primitive&& primitive, std::span<const std::uint32_t> position_of,
             std::span<const std::array<double, 3>> positions, const Take& take) const;

 private:
  using Cell = std::array<std::int64_t, 3>;
  static Cell cell_of(const std::array<double, 3>& position);
  void join_cells();

  const TileRef& tile_;
  std::map<Cell, PositionExtent> extents_;
  PositionExtent* last_extent_ = nullptr;  ///< of last_cell_
  Cell last_cell_{};
  bool is_one_group_ = false;  ///< there are too many cells
  std::map<Cell, std::size_t> group_;
  std::vector<MeshOrigin> origins_;  ///< at least one, once finished
};

}  // namespace gigabake
