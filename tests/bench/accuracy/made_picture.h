/// Images made for a test.
#pragma once

#include <cstdint>
#include <random>

#include "bench/accuracy/linear_picture.h"

namespace gigabake::bench {

inline LinearPicture plain(int width, int height, float r, float g, float b, float alpha) {
  LinearPicture picture{width, height, {}};
  for (int i = 0; i < width * height; ++i)
    picture.rgba.insert(picture.rgba.end(), {r * alpha, g * alpha, b * alpha, alpha});
  return picture;
}

/// Returns an image of random colours and coverages. Colours are premultiplied.
inline LinearPicture noise(int width, int height, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> any(0, 1);
  LinearPicture picture{width, height, {}};
  for (int i = 0; i < width * height; ++i) {
    const float alpha = any(random);
    for (int c = 0; c < 3; ++c) picture.rgba.push_back(alpha * any(random));
    picture.rgba.push_back(alpha);
  }
  return picture;
}

}  // namespace gigabake::bench
