/// How much light a picture lets through where none may pass.
#pragma once

#include <cstddef>
#include <vector>

#include "bench/accuracy/linear_picture.h"

namespace gigabake::bench {

/// What alpha is in truth, a value a pixel; row 0 is the upper one.
struct AlphaPicture {
  int width = 0, height = 0;
  std::vector<double> alpha;
};

/// Over inner pixels alone.
struct LeakError {
  std::size_t inner = 0;     ///< pixels; where there is none the figures are those of a picture without an error
  double below_99 = 0;       ///< share of them whose alpha is more than .01 below the true one
  double below_90 = 0;       ///< more than .1 below
  double least = 1;          ///< of their alpha
  double rms = 0, bias = 0;  ///< of alpha minus the true one
};

/// Pixels from a border beyond which a pixel shows nothing but the inside, whatever it is filtered with.
inline constexpr int inner_margin = 3;

/// 1 where `inside` has one and the same alpha, which is not 0, in the square of inner_margin around a pixel. Pixels
/// nearer to the picture's border than that are none.
std::vector<bool> inner_pixels(const AlphaPicture& inside);

/// Range  All of one size.
LeakError leak_error(const std::vector<bool>& inner, const AlphaPicture& truth, const LinearPicture& picture);

/// Of all pixels of both.
LeakError together(const LeakError& a, const LeakError& b);

/// What is asked of an opaque surface (docs/accuracy-rendering.md, Leaks).
inline constexpr double most_below_99 = 0.001, least_opaque_alpha = 0.95;
inline bool is_bounded(const LeakError& e) { return e.below_99 <= most_below_99 && e.least >= least_opaque_alpha; }

}  // namespace gigabake::bench
