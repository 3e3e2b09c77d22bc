/// Spatial search tree over the corners of a plane polygon.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace gigabake {

using PlaneCorner = std::array<double, 2>;

using PlaneTriangle = std::array<PlaneCorner, 3>;

/// Returns the doubled signed area of a triangle; positive if its corners are in counter-clockwise order.
inline double turn(const PlaneCorner& a, const PlaneCorner& b, const PlaneCorner& c) {
  return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

/// Returns the L1 distance |dx| + |dy|, an upper bound of the Euclidean distance.
inline double length(const PlaneCorner& a, const PlaneCorner& b) {
  return std::fabs(b[0] - a[0]) + std::fabs(b[1] - a[1]);
}

/// A k-d tree in one array. The middle element of each range splits the range along the longer side of its box.
class CornerTree {
 public:
  /// Builds the tree of `members`, indices of `points`. `points` must outlive the tree. Distances up to `noise` are
  /// rounding errors.
  CornerTree(const std::vector<PlaneCorner>& points, std::vector<std::uint32_t> members, double noise)
      : points_(points), order_(std::move(members)), noise_(noise) {
    for (const std::uint32_t i : order_)
      for (std::size_t c = 0; c < 2; ++c) {
        box_.low[c] = std::min(box_.low[c], points[i][c]);
        box_.high[c] = std::max(box_.high[c], points[i][c]);
      }
    left_.resize(order_.size());
    place_.resize(points.size(), none);
    sort({0, order_.size()}, box_);
  }

  /// Removes a point; does nothing if the point is not a member.
  /// Cost    O(log n).
  void remove(std::uint32_t point) {
    const std::uint32_t place = std::exchange(place_[point], none);
    if (place == none) return;
    for (Range range{0, order_.size()}; range.begin < range.end;) {
      const std::size_t middle = range.middle();
      --left_[middle];
      if (place == middle) return;
      range = place < middle ? Range{range.begin, middle} : Range{middle + 1, range.end};
    }
  }

  /// Returns whether is_hit(index) is true for a member near the triangle; stops at the first hit. Tests at least all
  /// members in the triangle or within `noise` of it.
  /// Range   The corners of the triangle are in counter-clockwise order.
  template <class IsHit>
  bool any_near(const PlaneTriangle& triangle, const IsHit& is_hit) const {
    return any_near(triangle, is_hit, {0, order_.size()}, box_);
  }

 private:
  static constexpr std::uint32_t none = ~std::uint32_t(0);

  struct Box {
    PlaneCorner low{HUGE_VAL, HUGE_VAL}, high{-HUGE_VAL, -HUGE_VAL};
    std::size_t axis() const { return high[0] - low[0] < high[1] - low[1] ? 1 : 0; }
  };
  struct Range {
    std::size_t begin, end;
    std::size_t middle() const { return begin + (end - begin) / 2; }
  };

  void sort(const Range& range, const Box& box) {
    if (range.begin == range.end) return;
    const std::size_t middle = range.middle(), axis = box.axis();
    const auto at = [this](std::size_t i) { return order_.begin() + std::ptrdiff_t(i); };
    std::nth_element(at(range.begin), at(middle), at(range.end),
                     [this, axis](std::uint32_t a, std::uint32_t b) { return points_[a][axis] < points_[b][axis]; });
    left_[middle] = std::uint32_t(range.end - range.begin);
    place_[order_[middle]] = std::uint32_t(middle);
    sort({range.begin, middle}, half(box, middle, true));
    sort({middle + 1, range.end}, half(box, middle, false));
  }

  /// Returns the half of the range's box that lies below or above the splitting member.
  Box half(Box box, std::size_t middle, bool is_below) const {
    const std::size_t axis = box.axis();
    (is_below ? box.high : box.low)[axis] = points_[order_[middle]][axis];
    return box;
  }

  /// Returns whether the box lies entirely outside one side of the triangle or of the triangle's bounding box, by more
  /// than the noise.
  bool is_apart(const PlaneTriangle& t, const Box& box) const {
    for (std::size_t c = 0; c < 2; ++c)
      if (std::max({t[0][c], t[1][c], t[2][c]}) + noise_ < box.low[c] ||
          std::min({t[0][c], t[1][c], t[2][c]}) - noise_ > box.high[c])
        return true;
    for (std::size_t k = 0; k < 3; ++k) {
      const PlaneCorner &a = t[k], &b = t[(k + 1) % 3];
      const PlaneCorner innermost{b[1] > a[1] ? box.low[0] : box.high[0], b[0] > a[0] ? box.high[1] : box.low[1]};
      if (turn(a, b, innermost) < -noise_ * length(a, b)) return true;
    }
    return false;
  }

  template <class IsHit>
  bool any_near(const PlaneTriangle& triangle, const IsHit& is_hit, const Range& range, const Box& box) const {
    if (range.begin == range.end) return false;
    const std::size_t middle = range.middle();
    if (left_[middle] == 0 || is_apart(triangle, box)) return false;
    if (place_[order_[middle]] == middle && is_hit(order_[middle])) return true;
    return any_near(triangle, is_hit, {range.begin, middle}, half(box, middle, true)) ||
           any_near(triangle, is_hit, {middle + 1, range.end}, half(box, middle, false));
  }

  const std::vector<PlaneCorner>& points_;
  std::vector<std::uint32_t> order_;
  std::vector<std::uint32_t> left_;   ///< number of remaining members per range, stored at its middle
  std::vector<std::uint32_t> place_;  ///< index in order_ per point, or `none`
  Box box_;
  double noise_;
};

}  // namespace gigabake
