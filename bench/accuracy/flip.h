/// How different two pictures look to somebody who flips between them.
#pragma once

#include <vector>

#include "bench/accuracy/linear_picture.h"

namespace gigabake::bench {

/// A display of 3840 pixels on 0.7 m, seen from 0.7 m.
inline constexpr double flip_pixels_per_degree = 67;

/// FLIP of each pixel; 0: no difference, 1: the greatest. Linear RGB, 0 … 1; beyond, the nearest of it.
/// Borders are filtered as if their pixels went on. Range  both pictures width × height, not empty.
/// Source  Andersson et al. 2020, "FLIP: A Difference Evaluator for Alternating Images", for low dynamic range, with
/// the
///         paper's constants.
std::vector<double> flip_map(const std::vector<Rgb>& reference, const std::vector<Rgb>& test, int width, int height);
/// Its mean.
double flip(const std::vector<Rgb>& reference, const std::vector<Rgb>& test, int width, int height);

}  // namespace gigabake::bench
