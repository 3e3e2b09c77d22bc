/// FLIP: the difference that a viewer perceives when alternating between two images.
#pragma once

#include <vector>

#include "bench/accuracy/linear_picture.h"

namespace gigabake::bench {

/// A display of 3840 pixels over 0.7 m, viewed from 0.7 m.
inline constexpr double flip_pixels_per_degree = 67;

/// Returns FLIP for each pixel; 0: no difference, 1: the maximum. Filters replicate the border pixels.
/// Range   Both images are width × height, not empty. Linear RGB is clamped to 0 … 1.
/// Source  Andersson et al. 2020, "FLIP: A Difference Evaluator for Alternating Images", for low dynamic range, with
///         the paper's constants.
std::vector<double> flip_map(const std::vector<Rgb>& reference, const std::vector<Rgb>& test, int width, int height);
/// Returns the mean of flip_map().
double flip(const std::vector<Rgb>& reference, const std::vector<Rgb>& test, int width, int height);

}  // namespace gigabake::bench
