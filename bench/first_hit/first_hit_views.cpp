#include "bench/first_hit/first_hit_views.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>

namespace gigabake::bench {
namespace {

using Vector = std::array<double, 3>;

Vector operator+(const Vector& a, const Vector& b) { return {a[0] + b[0], a[1] + b[1], a[2] + b[2]}; }
Vector operator*(const Vector& a, double s) { return {a[0] * s, a[1] * s, a[2] * s}; }
double dot(const Vector& a, const Vector& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
Vector unit(const Vector& a) { return a * (1 / std::sqrt(dot(a, a))); }
Vector cross(const Vector& a, const Vector& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

/// Forward, right and up vectors; up is north if the view is vertical.
struct Axes {
  Vector forward, right, up;
  explicit Axes(const Vector& towards) : forward(unit(towards)) {
    right = unit(cross(forward, std::fabs(forward[2]) > 0.999 ? Vector{0, 1, 0} : Vector{0, 0, 1}));
    up = cross(right, forward);
  }
};

/// A box in voxels: its centre and its half extents.
struct Box {
  Vector centre, half;
};

struct Picture {
  int width, height;
  double aspect() const { return double(width) / height; }
};

kernels::FirstHitCamera make_camera(const Box& box, const Vector& eye_from_centre, const Axes& axes,
                                    const Picture& picture) {
  kernels::FirstHitCamera c;
  const Vector eye = box.centre + eye_from_centre;
  for (std::size_t a = 0; a < 3; ++a) {
    c.eye[a] = eye[a];
    c.forward[a] = float(axes.forward[a]);
  }
  c.width = picture.width;
  c.height = picture.height;
  c.per_column = 2.0f / float(picture.width);
  c.per_row = 2.0f / float(picture.height);
  return c;
}

kernels::FirstHitCamera parallel(const Box& box, const Vector& towards, double half_height, const Picture& picture) {
  const Axes axes(towards);
  kernels::FirstHitCamera c = make_camera(box, axes.forward * -std::sqrt(dot(box.half, box.half)), axes, picture);
  for (std::size_t a = 0; a < 3; ++a) {
    c.across[a] = float(axes.right[a] * half_height * picture.aspect());
    c.upward[a] = float(axes.up[a] * half_height);
  }
  return c;
}

kernels::FirstHitCamera central(const Box& box, const Vector& eye_from_centre, const Vector& towards, double fovy_deg,
                                const Picture& picture) {
  const Axes axes(towards);
  kernels::FirstHitCamera c = make_camera(box, eye_from_centre, axes, picture);
  const double tangent = std::tan(fovy_deg * std::numbers::pi / 360);
  for (std::size_t a = 0; a < 3; ++a) {
    c.right[a] = float(axes.right[a] * tangent * picture.aspect());
    c.up[a] = float(axes.up[a] * tangent);
  }
  return c;
}

/// Calls visit(corner) with the corners at the box's middle height, relative to its centre. Views may therefore crop
/// mountains, but show less sky.
template <class Visit>
void for_each_corner(const Box& box, const Visit& visit) {
  for (int i = 0; i < 4; ++i)
    visit(Vector{(i & 1) != 0 ? box.half[0] : -box.half[0], (i & 2) != 0 ? box.half[1] : -box.half[1], 0});
}

/// Returns half the height of the smallest parallel image that shows the whole ground.
double fitting_half_height(const Box& box, const Vector& towards, const Picture& picture) {
  const Axes axes(towards);
  double half_height = 0;
  for_each_corner(box, [&](const Vector& corner) {
    half_height =
        std::max({half_height, std::fabs(dot(corner, axes.up)), std::fabs(dot(corner, axes.right)) / picture.aspect()});
  });
  return half_height;
}

/// Returns the distance from the centre at which an eye sees the whole ground.
double fitting_distance(const Box& box, const Vector& towards, double fovy_deg, const Picture& picture) {
  const Axes axes(towards);
  const double tangent = std::tan(fovy_deg * std::numbers::pi / 360);
  double distance = 0;
  for_each_corner(box, [&](const Vector& corner) {
    const double side =
        std::max(std::fabs(dot(corner, axes.up)), std::fabs(dot(corner, axes.right)) / picture.aspect());
    distance = std::max(distance, side / tangent - dot(corner, axes.forward));
  });
  return distance;
}

/// Returns the height of the ground in the middle of the box, relative to the centre. Returns 0 if there is no ground.
double ground_height(const kernels::FirstHitTree& tree, const Box& box) {
  kernels::FirstHitRay down;
  for (std::size_t a = 0; a < 3; ++a) down.origin[a] = box.centre[a];
  down.origin[2] += box.half[2];
  down.direction[2] = -1;
  std::uint32_t slots[kernels::first_hit_stack];
  const kernels::FirstHit hit = kernels::first_hit(tree, down, 0, kernels::FirstHitSlots<1>{slots});
  return hit.attributes_index == kernels::no_attributes ? 0 : box.half[2] - double(hit.distance);
}

Box box_of(const kernels::FirstHitTree& tree) {
  Box box{};
  for (std::size_t a = 0; a < 3; ++a) {
    box.centre[a] = tree.centre[a];
    box.half[a] = tree.half[a] * double(tree.edge);
  }
  return box;
}

}  // namespace

std::vector<FirstHitBenchView> first_hit_views(const kernels::FirstHitTree& tree, int width, int height) {
  const Picture picture{width, height};
  const Box box = box_of(tree);
  const Vector south_east{-0.62, 0.60, -0.505}, north_west{-1, 1, -0.18};
  constexpr double fovy_deg = 40, wide_fovy_deg = 60;
  const Vector half = box.half;
  const double ground = ground_height(tree, box), wide = std::max(half[0], half[1]);
  const double distance = fitting_distance(box, south_east, fovy_deg, picture);
  return {
      {"oblique, parallel", parallel(box, south_east, fitting_half_height(box, south_east, picture), picture)},
      {"oblique, perspective", central(box, unit(south_east) * -distance, south_east, fovy_deg, picture)},
      {"grazing", central(box, {half[0] * 1.05, -half[1] * 1.05, half[2] * 0.6}, north_west, wide_fovy_deg, picture)},
      {"random rays", std::nullopt},
      {"close, parallel", parallel(box, south_east, 0.45 * wide, picture)},
      {"close, perspective", central(box, unit(south_east) * (-1.3 * wide), south_east, fovy_deg, picture)},
      {"straight down", parallel(box, {0, 0, -1}, fitting_half_height(box, {0, 0, -1}, picture), picture)},
      {"ground level", central(box, {0, 0, ground + 10}, {-1, 0.4, -0.1}, wide_fovy_deg, picture)},
      {"underground", central(box, {0, 0, ground - 0.4 * half[2]}, {-0.7, 1, 0.4}, wide_fovy_deg, picture)},
  };
}

std::vector<kernels::FirstHitRay> random_rays(const kernels::FirstHitTree& tree, std::size_t count, unsigned seed) {
  const Box box = box_of(tree);
  std::mt19937_64 generator(seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  std::vector<kernels::FirstHitRay> rays(count);
  for (kernels::FirstHitRay& ray : rays) {
    Vector v;
    do v = {uniform(generator), uniform(generator), uniform(generator)};
    while (dot(v, v) > 1 || dot(v, v) < 1e-6);
    v = unit(v);
    for (std::size_t a = 0; a < 3; ++a) {
      ray.origin[a] = box.centre[a] + uniform(generator) * box.half[a];
      ray.direction[a] = float(v[a]);
    }
  }
  return rays;
}

}  // namespace gigabake::bench
