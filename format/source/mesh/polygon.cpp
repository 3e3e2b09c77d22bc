#include "format/source/mesh/polygon.h"

#include <cmath>
#include <numeric>

namespace gigabake {
namespace {

constexpr std::size_t most_clipped = 512;

using Corner = std::array<double, 2>;

/// Along the axis that the normal is nearest to; turning counter-clockwise.
std::vector<Corner> flattened(std::span<const std::array<double, 3>> corners) {
  std::array<double, 3> normal{};
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const auto &a = corners[i], &b = corners[(i + 1) % corners.size()];
    for (std::size_t c = 0; c < 3; ++c) {
      const std::size_t u = (c + 1) % 3, v = (c + 2) % 3;
      normal[c] += (a[u] - b[u]) * (a[v] + b[v] - 2 * corners[0][v]);
    }
  }
  std::size_t axis = 0;
  for (std::size_t c = 1; c < 3; ++c)
    if (std::fabs(normal[c]) > std::fabs(normal[axis])) axis = c;
  std::size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
  if (normal[axis] < 0) std::swap(u, v);
  std::vector<Corner> flat;
  for (const auto& p : corners) flat.push_back({p[u] - corners[0][u], p[v] - corners[0][v]});
  return flat;
}

double turn(const Corner& a, const Corner& b, const Corner& c) {
  return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

bool is_inside(const Corner& p, const Corner& a, const Corner& b, const Corner& c) {
  return turn(a, b, p) >= 0 && turn(b, c, p) >= 0 && turn(c, a, p) >= 0;
}

bool is_convex(const std::vector<Corner>& flat) {
  for (std::size_t i = 0; i < flat.size(); ++i)
    if (turn(flat[i], flat[(i + 1) % flat.size()], flat[(i + 2) % flat.size()]) < 0) return false;
  return true;
}

bool is_ear(const std::vector<Corner>& flat, const std::vector<std::uint32_t>& left, std::size_t i) {
  const std::size_t n = left.size(), before = (i + n - 1) % n, after = (i + 1) % n;
  const Corner &a = flat[left[before]], &b = flat[left[i]], &c = flat[left[after]];
  if (!(turn(a, b, c) > 0)) return false;
  for (std::size_t k = 0; k < n; ++k) {
    const Corner& p = flat[left[k]];
    if (k != before && k != i && k != after && p != a && p != b && p != c && is_inside(p, a, b, c)) return false;
  }
  return true;
}

}  // namespace

std::vector<std::uint32_t> triangles_of_polygon(std::span<const std::array<double, 3>> corners) {
  std::vector<std::uint32_t> out, left(corners.size());
  std::iota(left.begin(), left.end(), 0u);
  const auto flat = corners.size() > 3 && corners.size() <= most_clipped ? flattened(corners) : std::vector<Corner>();
  while (left.size() > 3 && !flat.empty() && !is_convex(flat)) {
    std::size_t ear = 0;
    while (ear < left.size() && !is_ear(flat, left, ear)) ++ear;
    if (ear == left.size()) break;  // it crosses itself: the rest is a fan
    const std::size_t n = left.size();
    out.insert(out.end(), {left[(ear + n - 1) % n], left[ear], left[(ear + 1) % n]});
    left.erase(left.begin() + std::ptrdiff_t(ear));
  }
  for (std::size_t i = 1; i + 1 < left.size(); ++i) out.insert(out.end(), {left[0], left[i], left[i + 1]});
  return out;
}

}  // namespace gigabake
