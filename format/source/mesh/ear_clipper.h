/// Polygons in the plane as triangles.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "format/source/mesh/corner_tree.h"

namespace gigabake {

/// Cuts ears off a polygon that turns counter-clockwise, until three corners are left. Spikes, repeated corners and
/// corners on a straight line become triangles without area, so n corners always give n - 2 triangles.
/// Cost    n log n for most polygons. A polygon that crosses itself is cut somehow, with a bounded number of tests.
/// Source  Meisters 1975; only reflex corners can lie in the way of an ear.
class EarClipper {
 public:
  /// noise: distances between corners that are rounding errors.
  EarClipper(const std::vector<PlaneCorner>& corners, double noise);

  /// Returns indices of corners, three per triangle. Called once.
  std::vector<std::uint32_t> triangles();

 private:
  /// What may not lie in an ear: a corner inside or on its border; a corner inside.
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
  std::vector<std::uint32_t> queue_;  ///< corners that may be ears, in rounds
  std::vector<bool> is_clipped_, is_queued_;
  std::size_t left_;
  std::uint32_t first_ = 0;         ///< a corner that is left
  std::uint64_t tests_left_;        ///< comparisons of an ear with a corner, before the rest is cut without looking
  std::optional<CornerTree> tree_;  ///< of the reflex corners that are left
};

}  // namespace gigabake
