// Implements fault_of() of polygon.h by a sweep to the north over the edges of all rings.
#include <algorithm>
#include <array>

#include "format/area/polygon.h"

namespace gigabake {
namespace {

/// An edge, its ring and its index in the ring.
struct SweptEdge {
  RingEdge edge;
  std::size_t ring = 0, index = 0;
};

bool overlaps_in_x(const RingEdge& a, const RingEdge& b) {
  const auto [a_low, a_high] = std::minmax(a.a.x, a.b.x);
  const auto [b_low, b_high] = std::minmax(b.a.x, b.b.x);
  return a_low <= b_high && b_low <= a_high;
}

/// Returns whether the closed edges share a position.
/// Range   The boxes of the edges overlap.
bool touch(const RingEdge& a, const RingEdge& b) {
  return side_of(a.a, a.b, b.a) * side_of(a.a, a.b, b.b) <= 0 && side_of(b.a, b.b, a.a) * side_of(b.a, b.b, a.b) <= 0;
}

/// Returns whether the edges are on one line and share more than one position.
bool overlap_on_line(const RingEdge& a, const RingEdge& b) {
  if (side_of(a.a, a.b, b.a) != 0 || side_of(a.a, a.b, b.b) != 0) return false;
  const auto order = [](const FixedPoint& p) { return std::pair(p.y, p.x); };
  return std::max(order(a.a), order(b.a)) < std::min(order(a.b), order(b.b));
}

/// Returns whether the edges cross: each one has its ends on both sides of the other.
bool cross(const RingEdge& a, const RingEdge& b) {
  return side_of(a.a, a.b, b.a) * side_of(a.a, a.b, b.b) < 0 && side_of(b.a, b.b, a.a) * side_of(b.a, b.b, a.b) < 0;
}

/// Returns whether two edges make the polygon invalid.
bool conflict(const SweptEdge& a, const SweptEdge& b, const std::vector<Ring>& rings) {
  if (a.ring != b.ring) return cross(a.edge, b.edge) || overlap_on_line(a.edge, b.edge);
  const std::size_t size = rings[a.ring].size();
  const bool is_adjacent = (a.index + 1) % size == b.index || (b.index + 1) % size == a.index;
  return is_adjacent ? overlap_on_line(a.edge, b.edge) : touch(a.edge, b.edge);
}

std::string ring_name(std::size_t ring) { return ring == 0 ? "its outer ring" : "its hole " + std::to_string(ring); }

std::string conflict_text(const SweptEdge& a, const SweptEdge& b) {
  const auto [low, high] = std::minmax(a.index, b.index);
  if (a.ring == b.ring)
    return ring_name(a.ring) + " crosses or touches itself, at its edges " + std::to_string(low) + " and " +
           std::to_string(high);
  return ring_name(std::min(a.ring, b.ring)) + " and " + ring_name(std::max(a.ring, b.ring)) + " cross or overlap";
}

/// Returns the first conflict between two edges.
std::optional<std::string> crossing_of(const std::vector<Ring>& rings) {
  std::vector<SweptEdge> edges;
  for (std::size_t r = 0; r < rings.size(); ++r) {
    const std::vector<RingEdge> of_ring = edges_of(rings[r]);
    for (std::size_t i = 0; i < of_ring.size(); ++i) edges.push_back({of_ring[i], r, i});
  }
  std::sort(edges.begin(), edges.end(), [](const SweptEdge& a, const SweptEdge& b) { return a.edge.a.y < b.edge.a.y; });
  std::vector<SweptEdge> active;
  for (const SweptEdge& e : edges) {
    std::erase_if(active, [&](const SweptEdge& other) { return other.edge.b.y < e.edge.a.y; });
    for (const SweptEdge& other : active)
      if (overlaps_in_x(e.edge, other.edge) && conflict(e, other, rings)) return conflict_text(other, e);
    active.push_back(e);
  }
  return std::nullopt;
}

bool is_on_edge(const Ring& ring, const FixedPoint& p) {
  const FixedBox here{p, p};
  for (const RingEdge& e : edges_of(ring))
    if (intersects(e, here)) return true;
  return false;
}

/// Returns whether the hole lies inside the outer ring, if the rings do not cross. Positions on the outer ring do not
/// count.
bool is_hole_inside(const AreaPolygon& outer, const Ring& hole) {
  for (const FixedPoint& p : hole)
    if (!is_on_edge(outer.rings()[0], p)) return outer.contains(p);
  return true;
}

}  // namespace

std::optional<std::string> fault_of(const std::vector<Ring>& rings) {
  if (auto crossing = crossing_of(rings)) return crossing;
  const AreaPolygon outer({rings.at(0)});
  for (std::size_t r = 1; r < rings.size(); ++r)
    if (!is_hole_inside(outer, rings[r])) return ring_name(r) + " lies outside its outer ring";
  return std::nullopt;
}

}  // namespace gigabake
