#include "bench/accuracy/flip.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "bench/accuracy/colour_spaces.h"

namespace gigabake::bench {
namespace {

using Plane = std::vector<double>;
/// Weights of the pixels from -radius to +radius.
using Kernel = std::vector<double>;

struct Size {
  int width, height;
};

Plane filtered(const Plane& in, const Kernel& kernel, Size size, bool along_x) {
  const int radius = int(kernel.size() / 2), last = (along_x ? size.width : size.height) - 1;
  Plane out(in.size());
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) {
      double sum = 0;
      for (int k = -radius; k <= radius; ++k) {
        const int at = std::clamp((along_x ? x : y) + k, 0, last);
        sum += kernel[std::size_t(k + radius)] * in[std::size_t(along_x ? y * size.width + at : at * size.width + x)];
      }
      out[std::size_t(y * size.width + x)] = sum;
    }
  return out;
}

Plane filtered(const Plane& in, const Kernel& across, const Kernel& down, Size size) {
  return filtered(filtered(in, across, size, true), down, size, false);
}

template <class Weight>
Kernel sampled(int radius, const Weight& weight) {
  Kernel kernel;
  for (int k = -radius; k <= radius; ++k) kernel.push_back(weight(double(k)));
  return kernel;
}

/// Scales a kernel so that its positive weights add up to 1 and its negative weights to -1.
void normalize(Kernel& kernel) {
  double positive = 0, negative = 0;
  for (const double w : kernel) (w > 0 ? positive : negative) += std::fabs(w);
  for (double& w : kernel) w /= w > 0 ? positive : (negative > 0 ? negative : 1);
}

/// Contrast sensitivity of the eye in one opponent channel: a sum of Gaussians a √(π/b) e^(-π² d²/b), d in degrees.
struct Sensitivity {
  double a[2], b[2];
};
constexpr Sensitivity sensitivities[3] = {
    {{1, 0}, {0.0047, 1e-5}}, {{1, 0}, {0.0053, 1e-5}}, {{34.1, 13.5}, {0.04, 0.025}}};
constexpr double max_b = 0.04;

Plane seen(const Plane& in, const Sensitivity& s, Size size) {
  const int radius =
      int(std::ceil(3 * std::sqrt(max_b / (2 * std::pow(std::numbers::pi, 2))) * flip_pixels_per_degree));
  Plane out(in.size(), 0);
  double weights = 0;
  for (int g = 0; g < 2; ++g) {
    if (s.a[g] == 0) continue;
    Kernel kernel = sampled(radius, [&](double k) {
      return std::exp(-std::pow(std::numbers::pi * k / flip_pixels_per_degree, 2) / s.b[g]);
    });
    double sum = 0;
    for (const double w : kernel) sum += w;
    normalize(kernel);
    const double weight = s.a[g] * std::sqrt(std::numbers::pi / s.b[g]) * sum * sum;
    const Plane part = filtered(in, kernel, kernel, size);
    for (std::size_t i = 0; i < out.size(); ++i) out[i] += weight * part[i];
    weights += weight;
  }
  for (double& v : out) v /= weights;
  return out;
}

/// Returns the planes of opponent colours, linear in light.
std::array<Plane, 3> opponents(const std::vector<Rgb>& picture) {
  std::array<Plane, 3> planes;
  for (const Rgb& c : picture) {
    const auto p = relative_xyz({std::clamp(c[0], 0.0, 1.0), std::clamp(c[1], 0.0, 1.0), std::clamp(c[2], 0.0, 1.0)});
    planes[0].push_back(116 * p[1] - 16);
    planes[1].push_back(500 * (p[0] - p[1]));
    planes[2].push_back(200 * (p[1] - p[2]));
  }
  return planes;
}

/// Returns L*a*b* with chroma reduced in dark colours (Hunt effect).
std::array<double, 3> hunt_lab(const Rgb& c) {
  const auto lab = cie_lab(c);
  return {lab[0], 0.01 * lab[0] * lab[1], 0.01 * lab[0] * lab[2]};
}

double hyab(const std::array<double, 3>& a, const std::array<double, 3>& b) {
  return std::fabs(a[0] - b[0]) + std::hypot(a[1] - b[1], a[2] - b[2]);
}

std::vector<std::array<double, 3>> seen_colours(const std::array<Plane, 3>& opponent, Size size) {
  const Plane y = seen(opponent[0], sensitivities[0], size), cx = seen(opponent[1], sensitivities[1], size),
              cz = seen(opponent[2], sensitivities[2], size);
  std::vector<std::array<double, 3>> out;
  for (std::size_t i = 0; i < y.size(); ++i) {
    const double relative_y = (y[i] + 16) / 116;
    Rgb c = linear_rgb({relative_y + cx[i] / 500, relative_y, relative_y - cz[i] / 200});
    for (double& v : c) v = std::clamp(v, 0.0, 1.0);
    out.push_back(hunt_lab(c));
  }
  return out;
}

/// Returns the colour difference in 0 … 1. Differences up to 0.4 of the maximum are mapped to 0 … 0.95, larger
/// differences to 0.95 … 1.
double colour_difference(const std::array<double, 3>& a, const std::array<double, 3>& b) {
  constexpr double exponent = 0.7, knee = 0.4, at_knee = 0.95;
  static const double greatest = std::pow(hyab(hunt_lab({0, 1, 0}), hunt_lab({0, 0, 1})), exponent);
  const double difference = std::pow(hyab(a, b), exponent);
  if (difference < knee * greatest) return at_knee / (knee * greatest) * difference;
  return at_knee + (difference - knee * greatest) / (greatest - knee * greatest) * (1 - at_knee);
}

struct Features {
  Plane edge, point;
};

Features features(const Plane& achromatic, Size size) {
  constexpr double width_deg = 0.082;
  const double sigma = 0.5 * width_deg * flip_pixels_per_degree;
  const int radius = int(std::ceil(3 * sigma));
  const auto gauss = [&](double k) { return std::exp(-k * k / (2 * sigma * sigma)); };
  Kernel smooth = sampled(radius, gauss);
  Kernel slope = sampled(radius, [&](double k) { return -k * gauss(k); });
  Kernel bend = sampled(radius, [&](double k) { return (k * k / (sigma * sigma) - 1) * gauss(k); });
  for (Kernel* kernel : {&smooth, &slope, &bend}) normalize(*kernel);
  Plane y(achromatic.size());
  std::transform(achromatic.begin(), achromatic.end(), y.begin(), [](double v) { return (v + 16) / 116; });
  const auto magnitude = [&](const Kernel& kernel) {
    Plane out = filtered(y, kernel, smooth, size);
    const Plane down = filtered(y, smooth, kernel, size);
    for (std::size_t i = 0; i < out.size(); ++i) out[i] = std::hypot(out[i], down[i]);
    return out;
  };
  return {magnitude(slope), magnitude(bend)};
}

}  // namespace

std::vector<double> flip_map(const std::vector<Rgb>& reference, const std::vector<Rgb>& test, int width, int height) {
  const Size size{width, height};
  const auto a = opponents(reference), b = opponents(test);
  const auto colour_a = seen_colours(a, size), colour_b = seen_colours(b, size);
  const Features feature_a = features(a[0], size), feature_b = features(b[0], size);
  std::vector<double> out;
  for (std::size_t i = 0; i < colour_a.size(); ++i) {
    const double feature =
        std::max(std::fabs(feature_a.edge[i] - feature_b.edge[i]), std::fabs(feature_a.point[i] - feature_b.point[i]));
    const double feature_difference = std::min(1.0, std::sqrt(feature / std::numbers::sqrt2));
    out.push_back(std::pow(colour_difference(colour_a[i], colour_b[i]), 1 - feature_difference));
  }
  return out;
}

double flip(const std::vector<Rgb>& reference, const std::vector<Rgb>& test, int width, int height) {
  const std::vector<double> map = flip_map(reference, test, width, height);
  return std::accumulate(map.begin(), map.end(), 0.0) / double(map.size());
}

}  // namespace gigabake::bench
