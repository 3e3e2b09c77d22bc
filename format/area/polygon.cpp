#include "format/area/polygon.h"

#include <algorithm>
#include <utility>

namespace gigabake {
namespace {

/// The mean number of edges per strip.
constexpr std::size_t edges_per_strip = 4;

void extend(FixedBox& box, const FixedPoint& p) {
  box.low = {std::min(box.low.x, p.x), std::min(box.low.y, p.y)};
  box.high = {std::max(box.high.x, p.x), std::max(box.high.y, p.y)};
}

}  // namespace

std::vector<RingEdge> edges_of(const Ring& ring) {
  std::vector<RingEdge> edges;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    FixedPoint a = ring[i], b = ring[(i + 1) % ring.size()];
    if (std::pair(b.y, b.x) < std::pair(a.y, a.x)) std::swap(a, b);
    edges.push_back({a, b});
  }
  return edges;
}

bool intersects(const RingEdge& e, const FixedBox& box) {
  if (e.b.y < box.low.y || e.a.y > box.high.y) return false;
  if (std::max(e.a.x, e.b.x) < box.low.x || std::min(e.a.x, e.b.x) > box.high.x) return false;
  int left = 0, right = 0;
  for (const std::int64_t x : {box.low.x, box.high.x})
    for (const std::int64_t y : {box.low.y, box.high.y}) {
      const int side = side_of(e.a, e.b, {x, y});
      left += side > 0 ? 1 : 0;
      right += side < 0 ? 1 : 0;
    }
  return left != 4 && right != 4;
}

AreaPolygon::AreaPolygon(std::vector<Ring> rings) : rings_(std::move(rings)) {
  bounds_ = {rings_.at(0).at(0), rings_[0][0]};
  std::size_t count = 0;
  for (const Ring& ring : rings_) {
    for (const FixedPoint& p : ring) extend(bounds_, p);
    count += ring.size();
  }
  const std::size_t strips = 1 + count / edges_per_strip;
  strip_height_ = (bounds_.high.y - bounds_.low.y) / std::int64_t(strips) + 1;
  strips_.resize(strips);
  for (const Ring& ring : rings_)
    for (const RingEdge& edge : edges_of(ring)) {
      const auto [first, end] = strips_of(edge.a.y, edge.b.y);
      for (std::size_t s = first; s < end; ++s) strips_[s].push_back(edge);
    }
}

std::pair<std::size_t, std::size_t> AreaPolygon::strips_of(std::int64_t y_low, std::int64_t y_high) const {
  if (y_high < bounds_.low.y || y_low > bounds_.high.y) return {0, 0};
  const auto strip = [&](std::int64_t y) {
    return std::size_t((std::clamp(y, bounds_.low.y, bounds_.high.y) - bounds_.low.y) / strip_height_);
  };
  return {strip(y_low), strip(y_high) + 1};
}

bool AreaPolygon::contains(const FixedPoint& p) const {
  const auto [strip, end] = strips_of(p.y, p.y);
  if (strip == end) return false;
  bool is_inside = false;
  for (const RingEdge& e : strips_[strip])
    if (e.a.y <= p.y && p.y < e.b.y && side_of(e.a, e.b, p) > 0) is_inside = !is_inside;
  return is_inside;
}

AreaOverlap AreaPolygon::overlap(const FixedBox& box) const {
  const auto [first, end] = strips_of(box.low.y, box.high.y);
  for (std::size_t s = first; s < end; ++s)
    for (const RingEdge& e : strips_[s])
      if (intersects(e, box)) return AreaOverlap::border;
  return contains(box.low) ? AreaOverlap::inside : AreaOverlap::outside;
}

std::vector<RingEdge> AreaPolygon::edges_in(const FixedBox& box) const {
  std::vector<RingEdge> found;
  const auto [first, end] = strips_of(box.low.y, box.high.y);
  for (std::size_t s = first; s < end; ++s)
    for (const RingEdge& e : strips_[s])
      if (intersects(e, box)) found.push_back(e);
  std::sort(found.begin(), found.end());
  found.erase(std::unique(found.begin(), found.end()), found.end());
  return found;
}

}  // namespace gigabake
