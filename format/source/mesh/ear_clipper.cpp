#include "format/source/mesh/ear_clipper.h"

#include <cmath>
#include <utility>

namespace gigabake {
namespace {

constexpr std::uint64_t tests_per_corner = 256, max_tests = std::uint64_t(1) << 26;

}  // namespace

EarClipper::EarClipper(const std::vector<PlaneCorner>& corners, double noise)
    : corners_(corners),
      noise_(noise),
      is_clipped_(corners.size()),
      is_queued_(corners.size()),
      left_(corners.size()),
      tests_left_(std::min(max_tests, (corners.size() + 4096) * tests_per_corner)) {
  const auto n = std::uint32_t(corners.size());
  for (std::uint32_t i = 0; i < n; ++i) previous_.push_back((i + n - 1) % n), next_.push_back((i + 1) % n);
}

std::vector<std::uint32_t> EarClipper::triangles() {
  for (std::uint32_t i = 0; i < corners_.size(); ++i) clip_flat(i);
  build_tree();
  while (left_ > 3) {
    const std::size_t before = left_;
    if (tests_left_ > 0) clip_ears(Blocked::inside_or_on);
    if (tests_left_ > 0 && left_ == before) clip_ears(Blocked::inside);
    if (left_ == before) clip(flattest());  // the polygon crosses itself
  }
  out_.insert(out_.end(), {previous_[first_], first_, next_[first_]});
  return std::move(out_);
}

/// Returns whether the corner is a spike, repeated, or on the line through its neighbours.
bool EarClipper::is_flat(std::uint32_t i) const {
  const PlaneCorner &a = corners_[previous_[i]], &b = corners_[i], &c = corners_[next_[i]];
  return std::fabs(turn(a, b, c)) <= noise_ * (length(a, b) + length(b, c));
}

/// Cuts off a corner if it is flat, then its neighbours that thereby become flat, such as the rest of a spike.
void EarClipper::clip_flat(std::uint32_t i) {
  while (left_ > 3 && !is_clipped_[i] && is_flat(i)) {
    const std::uint32_t previous = previous_[i], next = next_[i];
    clip(i);
    i = is_flat(previous) ? previous : next;
  }
}

/// Tests all corners once. After each cut, tests the two neighbours of the cut corner again, because only these can
/// have become ears.
void EarClipper::clip_ears(Blocked blocked) {
  queue_all();
  for (std::size_t at = 0; at < queue_.size() && left_ > 3; ++at) {
    const std::uint32_t i = queue_[at];
    is_queued_[i] = false;
    if (is_clipped_[i] || !is_ear(i, blocked)) continue;
    const std::uint32_t previous = previous_[i], next = next_[i];
    clip(i);
    clip_flat(previous);
    clip_flat(next);
    for (const std::uint32_t beside : {previous, next})
      if (!is_clipped_[beside]) queue(beside);
  }
  for (const std::uint32_t i : queue_) is_queued_[i] = false;
  queue_.clear();
}

void EarClipper::queue(std::uint32_t i) {
  if (!is_queued_[i]) queue_.push_back(i);
  is_queued_[i] = true;
}

void EarClipper::queue_all() {
  std::uint32_t i = first_;
  for (std::size_t k = 0; k < left_; ++k, i = next_[i]) queue(i);
}

/// Builds the tree of reflex corners. Cutting ears does not make other corners reflex.
void EarClipper::build_tree() {
  std::vector<std::uint32_t> reflex;
  std::uint32_t i = first_;
  for (std::size_t k = 0; k < left_; ++k, i = next_[i])
    if (turn_at(i) <= 0) reflex.push_back(i);
  tree_.emplace(corners_, std::move(reflex), noise_);
}

bool EarClipper::is_ear(std::uint32_t i, Blocked blocked) {
  use_tests(1);
  if (!(turn_at(i) > 0)) return false;
  if (tests_left_ == 0) return true;
  return !tree_->any_near({corners_[previous_[i]], corners_[i], corners_[next_[i]]}, [&](std::uint32_t p) {
    use_tests(1);
    return blocks(p, i, blocked);
  });
}

bool EarClipper::blocks(std::uint32_t p, std::uint32_t ear, Blocked blocked) const {
  const std::uint32_t before = previous_[ear], after = next_[ear];
  if (p == before || p == ear || p == after) return false;
  const PlaneCorner &q = corners_[p], &a = corners_[before], &b = corners_[ear], &c = corners_[after];
  if (q == a || q == c) return false;
  const auto is_in_angle = [&](const PlaneCorner& r) { return turn(a, b, r) > 0 && turn(b, c, r) > 0; };
  // A corner at the tip of the ear blocks the ear only if the polygon continues from there into the ear's angle.
  if (q == b) return is_in_angle(corners_[previous_[p]]) || is_in_angle(corners_[next_[p]]);
  // After a cut along collinear corners, rounding errors leave these corners on either side of the cut.
  const double margin = blocked == Blocked::inside ? noise_ : -noise_;
  const auto is_left_of = [&](const PlaneCorner& from, const PlaneCorner& to) {
    return turn(from, to, q) >= margin * length(from, to);
  };
  return is_left_of(a, b) && is_left_of(b, c) && is_left_of(c, a);
}

void EarClipper::clip(std::uint32_t i) {
  out_.insert(out_.end(), {previous_[i], i, next_[i]});
  next_[previous_[i]] = next_[i];
  previous_[next_[i]] = previous_[i];
  is_clipped_[i] = true;
  if (tree_) {
    tree_->remove(i);
    for (const std::uint32_t beside : {previous_[i], next_[i]})
      if (turn_at(beside) > 0) tree_->remove(beside);
  }
  first_ = next_[i];
  --left_;
}

/// Returns the corner whose triangle has the smallest area, because cutting it off changes the polygon least.
std::uint32_t EarClipper::flattest() {
  std::uint32_t i = first_, best = first_;
  const std::size_t looked_at = tests_left_ == 0 ? 1 : left_;
  use_tests(looked_at);
  for (std::size_t k = 0; k < looked_at; ++k, i = next_[i])
    if (std::fabs(turn_at(i)) < std::fabs(turn_at(best))) best = i;
  return best;
}

}  // namespace gigabake
