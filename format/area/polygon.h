/// A polygon with holes in the coordinates of an area, and exact tests against it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "format/area/fixed_point.h"

namespace gigabake {

/// A closed ring without its repeated last position.
using Ring = std::vector<FixedPoint>;

/// An edge of a ring. `a` is the lower end, and the western end of a horizontal edge.
struct RingEdge {
  FixedPoint a, b;
  friend auto operator<=>(const RingEdge&, const RingEdge&) = default;
};

/// The position of a box relative to an area.
enum class AreaOverlap : std::uint8_t { outside, inside, border };

/// A polygon: an outer ring and holes.
/// Exact   A position is inside if a ray to the east crosses the rings an odd number of times. A position on an edge
///         belongs to the polygon on the edge's eastern side, or on its northern side if the edge is horizontal. Thus,
///         polygons that share an edge share no position and leave none out.
class AreaPolygon {
 public:
  AreaPolygon() = default;
  /// `rings` begins with the outer ring.
  explicit AreaPolygon(std::vector<Ring> rings);

  const std::vector<Ring>& rings() const { return rings_; }
  /// Returns the smallest box that contains the outer ring.
  const FixedBox& bounds() const { return bounds_; }
  bool contains(const FixedPoint& p) const;
  AreaOverlap overlap(const FixedBox& box) const;
  /// Returns the edges that intersect the box, sorted.
  std::vector<RingEdge> edges_in(const FixedBox& box) const;

 private:
  /// Returns the range of strips that the interval overlaps.
  std::pair<std::size_t, std::size_t> strips_of(std::int64_t y_low, std::int64_t y_high) const;

  std::vector<Ring> rings_;
  FixedBox bounds_;
  /// Edges by horizontal strip of equal height; an edge is listed in each strip that it overlaps.
  std::vector<std::vector<RingEdge>> strips_;
  std::int64_t strip_height_ = 1;
};

/// Returns all edges of a ring.
std::vector<RingEdge> edges_of(const Ring& ring);

/// Returns the edge's overlap with the closed box: true if they share a position.
bool intersects(const RingEdge& edge, const FixedBox& box);

/// Checks the rings of a polygon. Returns nullopt if no ring crosses or touches itself, no two rings cross or overlap,
/// and each hole lies inside the outer ring. Otherwise returns the fault as text, with the number of the ring.
std::optional<std::string> fault_of(const std::vector<Ring>& rings);

}  // namespace gigabake
