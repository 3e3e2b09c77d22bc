#include "bench/accuracy/leaks/leak_error.h"

#include <algorithm>
#include <cmath>

namespace gigabake::bench {
namespace {

/// The maximum difference of two alphas that count as equal.
constexpr double same = 1e-9;

bool is_inner(const AlphaPicture& inside, int x, int y) {
  if (x < inner_margin || y < inner_margin || x + inner_margin >= inside.width || y + inner_margin >= inside.height)
    return false;
  const auto at = [&](int i, int j) {
    return inside.alpha[std::size_t(j) * std::size_t(inside.width) + std::size_t(i)];
  };
  const double here = at(x, y);
  if (here <= same) return false;
  for (int j = y - inner_margin; j <= y + inner_margin; ++j)
    for (int i = x - inner_margin; i <= x + inner_margin; ++i)
      if (std::fabs(at(i, j) - here) > same) return false;
  return true;
}

double mean_of_both(const LeakError& a, double of_a, const LeakError& b, double of_b) {
  return (double(a.inner) * of_a + double(b.inner) * of_b) / double(a.inner + b.inner);
}

}  // namespace

std::vector<bool> inner_pixels(const AlphaPicture& inside) {
  std::vector<bool> inner;
  inner.reserve(inside.alpha.size());
  for (int y = 0; y < inside.height; ++y)
    for (int x = 0; x < inside.width; ++x) inner.push_back(is_inner(inside, x, y));
  return inner;
}

LeakError leak_error(const std::vector<bool>& inner, const AlphaPicture& reference_alpha,
                     const LinearPicture& picture) {
  LeakError e;
  std::size_t below_99 = 0, below_90 = 0;
  double sum = 0, squares = 0;
  for (std::size_t i = 0; i < inner.size(); ++i) {
    if (!inner[i]) continue;
    const double alpha = picture.alpha(i), off = alpha - reference_alpha.alpha[i];
    ++e.inner;
    below_99 += off < -0.01;
    below_90 += off < -0.1;
    e.minimum = std::min(e.minimum, alpha);
    sum += off;
    squares += off * off;
  }
  if (e.inner == 0) return e;
  const auto pixels = double(e.inner);
  e.below_99 = double(below_99) / pixels;
  e.below_90 = double(below_90) / pixels;
  e.bias = sum / pixels;
  e.rms = std::sqrt(squares / pixels);
  return e;
}

LeakError together(const LeakError& a, const LeakError& b) {
  if (a.inner == 0) return b;
  if (b.inner == 0) return a;
  LeakError e;
  e.inner = a.inner + b.inner;
  e.below_99 = mean_of_both(a, a.below_99, b, b.below_99);
  e.below_90 = mean_of_both(a, a.below_90, b, b.below_90);
  e.minimum = std::min(a.minimum, b.minimum);
  e.bias = mean_of_both(a, a.bias, b, b.bias);
  e.rms = std::sqrt(mean_of_both(a, a.rms * a.rms, b, b.rms * b.rms));
  return e;
}

}  // namespace gigabake::bench
