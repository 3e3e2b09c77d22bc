#include "worker/edit/level_bricks.h"

#include <algorithm>

namespace gigabake {
namespace {

using kernels::Level;

/// Appends the values [first, end) of voxels, `width` values each, if the array has any.
template <class Value>
void copy(const std::vector<Value>& from, std::uint64_t first, std::uint64_t end, std::size_t width,
          std::vector<Value>& to) {
  if (from.empty()) return;
  to.insert(to.end(), from.begin() + std::ptrdiff_t(width * first), from.begin() + std::ptrdiff_t(width * end));
}

void copy_voxels(const Level& from, std::uint64_t first, std::uint64_t end, Level& to) {
  copy(from.rgba, first, end, 4, to.rgba);
  copy(from.normal, first, end, 2, to.normal);
  copy(from.directional_coverage, first, end, directional_coverage_bytes, to.directional_coverage);
  copy(from.voxel_class, first, end, 1, to.voxel_class);
}

/// Tests whether two arrays have the same values for `voxels` voxels from `a` and `b` on.
template <class Value>
bool are_equal(const std::vector<Value>& in_a, std::uint64_t a, const std::vector<Value>& in_b, std::uint64_t b,
               std::uint64_t voxels, std::size_t width) {
  if (in_a.empty() || in_b.empty()) return in_a.empty() == in_b.empty();
  return std::equal(&in_a[width * a], &in_a[width * a] + width * voxels, &in_b[width * b]);
}

}  // namespace

void append_bricks(const Level& from, std::size_t begin, std::size_t end, Level& to) {
  if (begin == end) return;
  if (to.first.empty()) to.first.push_back(0);
  const std::uint64_t voxels = to.first.back(), first = from.first[begin];
  copy(from.key, begin, end, 1, to.key);
  copy(from.mask, begin, end, 8, to.mask);
  for (std::size_t b = begin + 1; b <= end; ++b) to.first.push_back(voxels + from.first[b] - first);
  copy_voxels(from, first, from.first[end], to);
}

void append_voxel(const Level& from, std::size_t voxel, Level& to) { copy_voxels(from, voxel, voxel + 1, to); }

std::size_t lower_brick(const Level& level, std::uint64_t key) {
  return std::size_t(std::lower_bound(level.key.begin(), level.key.end(), key) - level.key.begin());
}

std::size_t find_brick(const Level& level, std::uint64_t key) {
  const std::size_t at = lower_brick(level, key);
  return at < level.key.size() && level.key[at] == key ? at : level.key.size();
}

bool are_equal_bricks(const Level& a, std::size_t brick_a, const Level& b, std::size_t brick_b) {
  if (!std::equal(&a.mask[8 * brick_a], &a.mask[8 * brick_a] + 8, &b.mask[8 * brick_b])) return false;
  const std::uint64_t at_a = a.first[brick_a], at_b = b.first[brick_b], voxels = a.first[brick_a + 1] - at_a;
  return are_equal(a.rgba, at_a, b.rgba, at_b, voxels, 4) && are_equal(a.normal, at_a, b.normal, at_b, voxels, 2) &&
         are_equal(a.directional_coverage, at_a, b.directional_coverage, at_b, voxels, directional_coverage_bytes) &&
         are_equal(a.voxel_class, at_a, b.voxel_class, at_b, voxels, 1);
}

}  // namespace gigabake
