/// Triangulation of plane polygons.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "format/source/mesh/corner_tree.h"

namespace gigabake {

/// An ear clipper. It cuts ears off a counter-clockwise polygon until three corners remain. Spikes, repeated corners
/// and corners on a straight line become triangles of zero area, so n corners always give n - 2 triangles.
/// Cost    O(n log n) for typical polygons. The number of tests is bounded. The triangulation of a polygon that crosses
///         itself is arbitrary.
/// Source  Meisters 1975; only reflex corners can lie inside an ear.
class EarClipper {
 public:
  /// `corners` must outlive the object. Distances between corners up to `noise` are rounding errors.
  EarClipper(const std::vector<PlaneCorner>& corners, double noise);

  /// Returns indices of corners, three per triangle. Must be called only once.
  std::vector<std::uint32_t> triangles();

 private:
  /// The other corners that prevent a triangle from being an ear: corners inside it or on its border, or only corners
  /// inside it.
  enum class Blocked { inside_or_on, inside };

  double turn_at(std::uint32_t i) const { return turn(corners_[previous_[i]], corners_[i], corners_[next_[i]]); }
  bool is_flat(std::uint32_t i) const;
  bool is_ear(std::uint32_t i, Blocked blocked);
  bool blocks(std::uint32_t p, std::uint32_t ear, Blocked blocked) const;
  void clip(std::uint32_t i);
  void clip_flat(std::uint32_t i);
  void clip_ears(Blocked blocked);
  void build_tree();
  void queue(std::uint32_t i);
  void queue_all();
  std::uint32_t flattest();
  void use_tests(std::uint64_t tests) { tests_left_ -= std::min(tests, tests_left_); }

  const std::vector<PlaneCorner>& corners_;
  double noise_;
  std::vector<std::uint32_t> previous_, next_, out_;
  std::vector<std::uint32_t> queue_;  ///< corners that may be ears, in the order of their tests
  std::vector<bool> is_clipped_, is_queued_;
  std::size_t left_;
  std::uint32_t first_ = 0;         ///< a remaining corner
  std::uint64_t tests_left_;        ///< budget of ear/corner tests; at 0 the rest is cut without tests
  std::optional<CornerTree> tree_;  ///< the remaining reflex corners
};

}  // namespace gigabake
