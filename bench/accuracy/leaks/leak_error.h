/// Light leaks: how much light an image lets through at pixels that must be opaque.
#pragma once

#include <cstddef>
#include <vector>

#include "bench/accuracy/linear_picture.h"

namespace gigabake::bench {

/// The true alpha, one value per pixel; row 0 is the top row.
struct AlphaPicture {
  int width = 0, height = 0;
  std::vector<double> alpha;
};

/// The errors over inner pixels only.
struct LeakError {
  std::size_t inner = 0;     ///< number of inner pixels; if it is 0, the other members show no error
  double below_99 = 0;       ///< fraction of inner pixels with alpha more than 0.01 below the true alpha
  double below_90 = 0;       ///< fraction of inner pixels with alpha more than 0.1 below the true alpha
  double minimum = 1;        ///< minimum alpha
  double rms = 0, bias = 0;  ///< of alpha minus the true alpha
};

/// The distance from a border, in pixels, beyond which no filter reaches the border.
inline constexpr int inner_margin = 3;

/// Returns true for pixels where `inside` has the same non-zero alpha in the whole square of inner_margin around the
/// pixel. Pixels within inner_margin of the image border are not inner.
std::vector<bool> inner_pixels(const AlphaPicture& inside);

/// Measures an image over the inner pixels.
/// Range   All arguments have the same size.
LeakError leak_error(const std::vector<bool>& inner, const AlphaPicture& reference_alpha, const LinearPicture& picture);

/// Returns the errors over the inner pixels of a and b together.
LeakError together(const LeakError& a, const LeakError& b);

/// The bounds for an opaque surface (docs/accuracy-rendering.md, Leaks).
inline constexpr double max_below_99 = 0.001, min_opaque_alpha = 0.95;
inline bool is_bounded(const LeakError& e) { return e.below_99 <= max_below_99 && e.minimum >= min_opaque_alpha; }

}  // namespace gigabake::bench
