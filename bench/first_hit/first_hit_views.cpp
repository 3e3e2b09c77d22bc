#include "bench/first_hit/first_hit_views.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "core/math/vec3.h"

namespace gigabake::bench {
namespace {

Vec3d unit(const Vec3d& a) { return a * (1 / length(a)); }

/// Forward, right and up vectors; up is north if the view is vertical.
struct Axes {
  Vec3d forward, right, up;
  explicit Axes(const Vec3d& towards) : forward(unit(towards)) {
    right = unit(cross(forward, std::fabs(forward[2]) > 0.999 ? Vec3d{0, 1, 0} : Vec3d{0, 0, 1}));
    up = cross(right, forward);
  }
};

/// A box in voxels: its centre and its half extents.
struct Box {
  Vec3d centre, half;
};

struct Picture {
  int width, height;
  double aspect() const { return double(width) / height; }
};

kernels::FirstHitCamera make_camera(const Box& box, const Vec3d& eye_from_centre, const Axes& axes,
                                    const Picture& picture) {
  kernels::FirstHitCamera c;
  const Vec3d eye = box.centre + eye_from_centre;
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

kernels::FirstHitCamera parallel(const Box& box, const Vec3d& towards, double half_height, const Picture& picture) {
  const Axes axes(towards);
  kernels::FirstHitCamera c = make_camera(box, axes.forward * -length(box.half), axes, picture);
  for (std::size_t a = 0; a < 3; ++a) {
    c.across[a] = float(axes.right[a] * half_height * picture.aspect());
    c.upward[a] = float(axes.up[a] * half_height);
  }
  return c;
}

kernels::FirstHitCamera central(const Box& box, const Vec3d& eye_from_centre, const Vec3d& towards, double fovy_deg,
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
    visit(Vec3d{(i & 1) != 0 ? box.half[0] : -box.half[0], (i & 2) != 0 ? box.half[1] : -box.half[1], 0});
}

/// Returns half the height of the smallest parallel image that shows the whole ground.
double fitting_half_height(const Box& box, const Vec3d& towards, const Picture& picture) {
  const Axes axes(towards);
  double half_height = 0;
  for_each_corner(box, [&](const Vec3d& corner) {
    half_height =
        std::max({half_height, std::fabs(dot(corner, axes.up)), std::fabs(dot(corner, axes.right)) / picture.aspect()});
  });
  return half_height;
}

/// Returns the distance from the centre at which an eye sees the whole ground.
double fitting_distance(const Box& box, const Vec3d& towards, double fovy_deg, const Picture& picture) {
  const Axes axes(towards);
  const double tangent = std::tan(fovy_deg * std::numbers::pi / 360);
  double distance = 0;
  for_each_corner(box, [&](const Vec3d& corner) {
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
  return {Vec3d::from(tree.centre), Vec3d::from(tree.half) * double(tree.edge)};
}

}  // namespace

std::vector<FirstHitBenchView> first_hit_views(const kernels::FirstHitTree& tree, int width, int height) {
  const Picture picture{width, height};
  const Box box = box_of(tree);
  const Vec3d south_east{-0.62, 0.60, -0.505}, north_west{-1, 1, -0.18};
  constexpr double fovy_deg = 40, wide_fovy_deg = 60;
  const Vec3d half = box.half;
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
    Vec3d v;
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
