/// Images in memory, and as JPEG and PNG bytes.
#pragma once

#include <cstdint>
#include <vector>

namespace gigabake::sample {

/// An sRGB colour with components from 0 to 255.
struct Rgb {
  double r = 0, g = 0, b = 0;
};

Rgb mix(const Rgb& a, const Rgb& b, double t);
Rgb scaled(const Rgb& c, double factor);

/// An image; rows from the top, `channels` bytes per pixel.
struct Picture {
  int width = 0, height = 0, channels = 3;
  std::vector<std::uint8_t> bytes;

  Picture(int w, int h, int c) : width(w), height(h), channels(c), bytes(std::size_t(w) * h * c, 0) {}
  std::uint8_t* at(int x, int y) { return &bytes[(std::size_t(y) * width + x) * channels]; }
  void set(int x, int y, const Rgb& c);  ///< rounds and clamps; does not change alpha
};

/// Encodes 3 channels as JPEG.
/// Exact   Uses the integer transform, so equal images give equal bytes.
std::vector<std::uint8_t> to_jpeg(const Picture& picture, int quality);
/// Encodes 3 or 4 channels as PNG.
std::vector<std::uint8_t> to_png(const Picture& picture);

}  // namespace gigabake::sample
