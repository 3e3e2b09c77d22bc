#include "worker/edit/polygon_pieces.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace gigabake {
namespace {

using PieceCorners = std::vector<PieceCorner>;

PieceCorner between(const PieceCorner& a, const PieceCorner& b, double t) {
  PieceCorner out{a.x + t * (b.x - a.x), a.y + t * (b.y - a.y), {}};
  for (std::size_t c = 0; c < 3; ++c) out.weight[c] = a.weight[c] + t * (b.weight[c] - a.weight[c]);
  return out;
}

/// A side with or without its border. Only pieces without area in the plane can lie on a border.
enum class Border { included, excluded };

/// Returns the part of a convex piece on which `distance` is not negative. A cut is computed from the end with the
/// lower position, so that the pieces on both sides get the same corner.
template <class Distance>
PieceCorners clipped(const PieceCorners& corners, Border border, const Distance& distance) {
  double min = 0, max = 0;
  for (const PieceCorner& p : corners) min = std::min(min, distance(p)), max = std::max(max, distance(p));
  if (max <= 0 && (border == Border::excluded || min < 0)) return {};
  PieceCorners out;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const PieceCorner &a = corners[i], &b = corners[(i + 1) % corners.size()];
    const double at_a = distance(a), at_b = distance(b);
    if (at_a >= 0) out.push_back(a);
    if ((at_a > 0 && at_b < 0) || (at_a < 0 && at_b > 0)) {
      const bool is_forward = std::pair(a.x, a.y) < std::pair(b.x, b.y);
      out.push_back(is_forward ? between(a, b, at_a / (at_a - at_b)) : between(b, a, at_b / (at_b - at_a)));
    }
  }
  return out.size() < 3 ? PieceCorners() : out;
}

/// An edge of the polygon that spans a slab, relative to the triangle's first corner.
struct SlabEdge {
  double x = 0, y = 0, dx = 0, dy = 0;
  double middle_x = 0;  ///< in the middle of the slab

  /// Returns a number that is positive east of the edge.
  double east(const PieceCorner& p) const { return (p.x - x) * dy - (p.y - y) * dx; }
};

class TriangleCutter {
 public:
  TriangleCutter(const std::array<std::array<double, 2>, 3>& triangle, const AreaPolygon& polygon)
      : polygon_(polygon), origin_{to_fixed(triangle[0][0]), to_fixed(triangle[0][1])} {
    for (std::size_t i = 0; i < 3; ++i) {
      const FixedPoint p{to_fixed(triangle[i][0]), to_fixed(triangle[i][1])};
      whole_.push_back({double(p.x - origin_.x), double(p.y - origin_.y), {}});
      whole_.back().weight[i] = 1;
      low_ = std::min(low_, p.y), high_ = std::max(high_, p.y);
    }
  }

  std::vector<TrianglePiece> run() {
    const std::vector<std::int64_t> cuts = heights();
    for (std::size_t s = 0; s + 1 < cuts.size(); ++s) cut_slab(cuts[s], cuts[s + 1]);
    return std::move(pieces_);
  }

 private:
  /// Returns the heights of the triangle's ends and of the polygon's corners between them.
  std::vector<std::int64_t> heights() const {
    std::vector<std::int64_t> y{low_, std::max(high_, low_ + 1)};
    for (const Ring& ring : polygon_.rings())
      for (const FixedPoint& p : ring)
        if (p.y > low_ && p.y < high_) y.push_back(p.y);
    std::sort(y.begin(), y.end());
    y.erase(std::unique(y.begin(), y.end()), y.end());
    return y;
  }

  std::vector<SlabEdge> edges_between(std::int64_t low, std::int64_t high) const {
    const FixedBox& box = polygon_.bounds();
    std::vector<SlabEdge> edges;
    for (const RingEdge& e : polygon_.edges_in({{box.low.x, low}, {box.high.x, high}})) {
      if (e.a.y > low || e.b.y < high || e.a.y == e.b.y) continue;
      SlabEdge edge{double(e.a.x - origin_.x), double(e.a.y - origin_.y), double(e.b.x - e.a.x), double(e.b.y - e.a.y),
                    0};
      const double middle_y = (double(low - origin_.y) + double(high - origin_.y)) / 2;
      edge.middle_x = edge.x + edge.dx * ((middle_y - edge.y) / edge.dy);
      edges.push_back(edge);
    }
    std::sort(edges.begin(), edges.end(), [](const auto& a, const auto& b) { return a.middle_x < b.middle_x; });
    return edges;
  }

  /// Cuts the part of the triangle between two heights along the edges, from west to east. No edge ends between the
  /// heights, so sides alternate.
  void cut_slab(std::int64_t low, std::int64_t high) {
    const double y0 = double(low - origin_.y), y1 = double(high - origin_.y);
    PieceCorners rest = whole_;
    if (low > low_) rest = clipped(rest, Border::included, [&](const PieceCorner& p) { return p.y - y0; });
    if (high < high_) rest = clipped(rest, Border::excluded, [&](const PieceCorner& p) { return y1 - p.y; });
    bool is_inside = false;
    for (const SlabEdge& edge : edges_between(low, high)) {
      add(clipped(rest, Border::excluded, [&](const PieceCorner& p) { return -edge.east(p); }), is_inside);
      rest = clipped(rest, Border::included, [&](const PieceCorner& p) { return edge.east(p); });
      is_inside = !is_inside;
    }
    add(std::move(rest), is_inside);
  }

  void add(PieceCorners corners, bool is_inside) {
    if (!corners.empty()) pieces_.push_back({std::move(corners), is_inside});
  }

  const AreaPolygon& polygon_;
  FixedPoint origin_;
  std::int64_t low_ = std::numeric_limits<std::int64_t>::max(), high_ = std::numeric_limits<std::int64_t>::min();
  PieceCorners whole_;
  std::vector<TrianglePiece> pieces_;
};

}  // namespace

std::vector<TrianglePiece> pieces_of(const std::array<std::array<double, 2>, 3>& triangle, const AreaPolygon& polygon) {
  return TriangleCutter(triangle, polygon).run();
}

}  // namespace gigabake
