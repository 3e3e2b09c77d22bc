#include "bench/accuracy/picture_error.h"

#include <algorithm>
#include <cmath>

#include "bench/accuracy/colour_spaces.h"
#include "bench/accuracy/flip.h"

namespace gigabake::bench {
namespace {

constexpr double best_psnr_db = 100;
constexpr float opaque = 0.999f, half_covered = 0.5f;

Rgb straight(const LinearPicture& picture, std::size_t pixel) {
  const float* p = &picture.rgba[4 * pixel];
  return {p[0] / p[3], p[1] / p[3], p[2] / p[3]};
}

class Mean {
 public:
  void add(double v) {
    sum_ += v;
    ++count_;
  }
  double value(double of_none = 0) const { return count_ > 0 ? sum_ / count_ : of_none; }

 private:
  double sum_ = 0, count_ = 0;
};

bool is_scene(const LinearPicture& a, const LinearPicture& b, std::size_t pixel) {
  return a.alpha(pixel) > 0 || b.alpha(pixel) > 0;
}

double psnr_db(const LinearPicture& reference, const LinearPicture& picture, double background) {
  const std::vector<Rgb> a = over(reference, background), b = over(picture, background);
  Mean squared;
  for (std::size_t i = 0; i < a.size(); ++i)
    for (std::size_t c = 0; c < 3 && is_scene(reference, picture, i); ++c)
      squared.add(std::pow(srgb_code(a[i][c]) - srgb_code(b[i][c]), 2));
  return squared.value() > 0 ? std::min(best_psnr_db, -10 * std::log10(squared.value())) : best_psnr_db;
}

double worse_flip(const LinearPicture& reference, const LinearPicture& picture) {
  double worst = 0;
  for (const double background : {0.0, 1.0})
    worst = std::max(worst,
                     flip(over(reference, background), over(picture, background), reference.width, reference.height));
  return worst;
}

void compare_coverage(const LinearPicture& reference, const LinearPicture& picture, PictureError& e) {
  Mean bias, holes, overlap;
  for (std::size_t i = 0; i < reference.pixels(); ++i) {
    const float a = reference.alpha(i), b = picture.alpha(i);
    if (is_scene(reference, picture, i)) bias.add(double(b) - a);
    if (a >= opaque) holes.add(std::max(0.0, 1 - double(b)));
    if (a >= half_covered || b >= half_covered) overlap.add(a >= half_covered && b >= half_covered ? 1 : 0);
  }
  e.coverage_bias = bias.value();
  e.holes = holes.value();
  e.silhouette_iou = overlap.value(1);
}

void compare_colour(const LinearPicture& reference, const LinearPicture& picture, PictureError& e) {
  Mean squared, delta_e;
  for (std::size_t i = 0; i < reference.pixels(); ++i) {
    if (reference.alpha(i) < half_covered || picture.alpha(i) < half_covered) continue;
    const Rgb a = straight(reference, i), b = straight(picture, i);
    for (std::size_t c = 0; c < 3; ++c) squared.add(std::pow(a[c] - b[c], 2));
    const auto p = cie_lab(a), q = cie_lab(b);
    delta_e.add(std::hypot(p[0] - q[0], p[1] - q[1], p[2] - q[2]));
  }
  e.rms_colour = std::sqrt(squared.value());
  e.delta_e = delta_e.value();
}

}  // namespace

PictureError picture_error(const LinearPicture& reference, const LinearPicture& picture) {
  PictureError e;
  e.psnr_black_db = psnr_db(reference, picture, 0);
  e.psnr_white_db = psnr_db(reference, picture, 1);
  compare_coverage(reference, picture, e);
  compare_colour(reference, picture, e);
  e.flip = worse_flip(reference, picture);
  return e;
}

PictureError mean_error(const std::vector<PictureError>& errors) {
  PictureError mean;
  for (const PictureError& e : errors) {
    const double share = 1 / double(errors.size());
    mean.psnr_black_db += share * e.psnr_black_db;
    mean.psnr_white_db += share * e.psnr_white_db;
    mean.silhouette_iou += share * e.silhouette_iou;
    mean.coverage_bias += share * std::fabs(e.coverage_bias);
    mean.holes += share * e.holes;
    mean.rms_colour += share * e.rms_colour;
    mean.delta_e += share * e.delta_e;
    mean.flip += share * e.flip;
  }
  return mean;
}

}  // namespace gigabake::bench
