#include <algorithm>
#include <cmath>

#include "sample/settlement/building_kit.h"
#include "sample/terrain/noise.h"

namespace gigabake::sample {
namespace {

constexpr double overhang_m = 0.45;

void add_vertex(GlbMesh& mesh, const Corner& c, const double uv[2]) {
  mesh.position.insert(mesh.position.end(), {float(c.e_m), float(c.u_m), float(-c.n_m)});
  for (int k = 0; k < 2; ++k) mesh.uv.push_back(std::uint16_t(clamp01(uv[k]) * 65535 + 0.5));
}

/// The frame of a house: x along the ridge, y across it.
struct HouseFrame {
  MapPoint centre;
  Turn turn;
  Corner at(double x_m, double y_m, double u_m) const {
    return {centre.e_m + x_m * turn.cosine - y_m * turn.sine, centre.n_m + x_m * turn.sine + y_m * turn.cosine, u_m};
  }
};

/// Appends a wall from (x0, y0) to (x1, y1), with its outside on the right-hand side of that direction.
void add_wall(GlbMesh& mesh, const HouseFrame& f, double x0, double y0, double x1, double y1, double base_m,
              double floor_m, double wall_m) {
  const double width_m = std::fabs(x1 - x0) + std::fabs(y1 - y0);
  const double u0 = 0.5 - width_m / facade_m / 2, u1 = 0.5 + width_m / facade_m / 2;
  const double v0 = 1 - (base_m - floor_m) / facade_m, v1 = 1 - wall_m / facade_m;
  const Corner c[4] = {f.at(x0, y0, base_m), f.at(x1, y1, base_m), f.at(x1, y1, floor_m + wall_m),
                       f.at(x0, y0, floor_m + wall_m)};
  const double uv[4][2] = {{u0, v0}, {u1, v0}, {u1, v1}, {u0, v1}};
  add_quad(mesh, c, uv);
}

/// Appends the triangle of wall under the roof at the end `x` of the ridge. Its front faces outward.
void add_gable(GlbMesh& mesh, const HouseFrame& f, double x, double half_depth, double eaves_m, double ridge_m) {
  const double side = x < 0 ? 1 : -1;
  const Corner c[3] = {f.at(x, side * half_depth, eaves_m), f.at(x, -side * half_depth, eaves_m), f.at(x, 0, ridge_m)};
  const double half = half_depth / facade_m, low = 1 - 5.7 / facade_m, high = 1 - (5.7 + ridge_m - eaves_m) / facade_m;
  const double uv[3][2] = {{0.5 - half, low}, {0.5 + half, low}, {0.5, high}};
  add_triangle(mesh, c, uv);
}

void add_card(GlbMesh& mesh, const Corner& middle, const Corner& right, const Corner& up, bool needles) {
  const auto at = [&](double a, double b) {
    return Corner{middle.e_m + a * right.e_m + b * up.e_m, middle.n_m + a * right.n_m + b * up.n_m,
                  middle.u_m + a * right.u_m + b * up.u_m};
  };
  const Corner c[4] = {at(-1, -1), at(1, -1), at(1, 1), at(-1, 1)};
  const double u0 = needles ? 0.502 : 0.002, u1 = needles ? 0.998 : 0.498;
  const double uv[4][2] = {{u0, 0.998}, {u1, 0.998}, {u1, 0.002}, {u0, 0.002}};
  add_quad(mesh, c, uv);
}

void add_trunk(GlbMesh& mesh, const Corner& foot, double radius_m, double height_m) {
  constexpr int sides = 5;
  const double uv[4][2] = {{0, 0}, {0, 0}, {0, 0}, {0, 0}};
  for (int i = 0; i < sides; ++i) {
    const Turn a = turn_of(i * 72), b = turn_of((i + 1) * 72);
    const auto at = [&](const Turn& t, double r, double u) {
      return Corner{foot.e_m + r * t.cosine, foot.n_m + r * t.sine, foot.u_m + u};
    };
    const Corner c[4] = {at(a, radius_m, -0.5), at(b, radius_m, -0.5), at(b, radius_m * 0.5, height_m),
                         at(a, radius_m * 0.5, height_m)};
    add_quad(mesh, c, uv);
  }
}

/// Appends a square card of the crown, `reach_m` from `centre` in direction `heading_deg`, tilted up by `lift_deg`.
/// half_m is half the card's edge.
void add_crown_card(const Tree& tree, const Corner& centre, double heading_deg, double lift_deg, double reach_m,
                    double half_m, GlbMesh& foliage) {
  const Turn h = turn_of(heading_deg), l = turn_of(lift_deg);
  const Corner out{h.cosine * l.cosine, h.sine * l.cosine, l.sine};
  const Corner middle{centre.e_m + reach_m * out.e_m, centre.n_m + reach_m * out.n_m, centre.u_m + reach_m * out.u_m};
  const Corner right{-h.sine * half_m, h.cosine * half_m, 0};
  const Corner up{-h.cosine * l.sine * half_m, -h.sine * l.sine * half_m, l.cosine * half_m};
  add_card(foliage, middle, right, up, tree.kind == TreeKind::conifer);
}

}  // namespace

void add_triangle(GlbMesh& mesh, const Corner corners[3], const double uv[3][2]) {
  const auto first = std::uint32_t(mesh.vertices());
  for (int i = 0; i < 3; ++i) add_vertex(mesh, corners[i], uv[i]);
  mesh.index.insert(mesh.index.end(), {first, first + 1, first + 2});
}

void add_quad(GlbMesh& mesh, const Corner corners[4], const double uv[4][2]) {
  const auto first = std::uint32_t(mesh.vertices());
  for (int i = 0; i < 4; ++i) add_vertex(mesh, corners[i], uv[i]);
  mesh.index.insert(mesh.index.end(), {first, first + 1, first + 2, first, first + 2, first + 3});
}

void add_house(const House& h, MapPoint local_centre, double base_m, double floor_m, GlbMesh& walls, GlbMesh& roof) {
  const HouseFrame f{local_centre, turn_of(h.heading_deg)};
  const double x = h.length_m / 2, y = h.depth_m / 2, eaves_m = floor_m + h.wall_m, ridge_m = eaves_m + h.roof_m;
  add_wall(walls, f, -x, -y, x, -y, base_m, floor_m, h.wall_m);
  add_wall(walls, f, x, -y, x, y, base_m, floor_m, h.wall_m);
  add_wall(walls, f, x, y, -x, y, base_m, floor_m, h.wall_m);
  add_wall(walls, f, -x, y, -x, -y, base_m, floor_m, h.wall_m);
  add_gable(walls, f, -x, y, eaves_m, ridge_m);
  add_gable(walls, f, x, y, eaves_m, ridge_m);
  const double ex = x + overhang_m, ey = y + overhang_m, low_m = eaves_m - overhang_m * h.roof_m / y;
  const double u1 = std::min(1.0, 2 * ex / roof_width_m),
               v1 = std::sqrt(ey * ey + (ridge_m - low_m) * (ridge_m - low_m)) / roof_height_m;
  const double uv[4][2] = {{0, v1}, {u1, v1}, {u1, 0}, {0, 0}};
  const Corner south[4] = {f.at(-ex, -ey, low_m), f.at(ex, -ey, low_m), f.at(ex, 0, ridge_m), f.at(-ex, 0, ridge_m)};
  const Corner north[4] = {f.at(ex, ey, low_m), f.at(-ex, ey, low_m), f.at(-ex, 0, ridge_m), f.at(ex, 0, ridge_m)};
  add_quad(roof, south, uv);
  add_quad(roof, north, uv);
}

void add_tree(const Tree& tree, Corner foot, GlbMesh& bark, GlbMesh& foliage) {
  Random random(tree.seed);
  const double radius_m = tree.crown_m / 2;
  add_trunk(bark, foot, 0.03 * tree.height_m, 0.75 * tree.height_m);
  if (tree.kind == TreeKind::conifer) {
    for (int tier = 0; tier < 5; ++tier) {
      const double share = tier / 5.0, reach_m = radius_m * (1 - share) * 0.62;
      const Corner centre{foot.e_m, foot.n_m, foot.u_m + tree.height_m * (0.2 + 0.72 * share)};
      const double turn_deg = random.between(0, 360);
      for (int k = 0; k < 5; ++k)
        add_crown_card(tree, centre, turn_deg + 72 * k, 42, reach_m, radius_m * (1 - share) * 0.62 + 0.35, foliage);
    }
    return;
  }
  const double centre_m = tree.height_m - radius_m * 0.95;
  const Corner centre{foot.e_m, foot.n_m, foot.u_m + centre_m};
  constexpr double lifts[4] = {-25, 10, 45, 90};
  constexpr int cards[4] = {5, 6, 5, 1};
  for (int ring = 0; ring < 4; ++ring) {
    const double turn_deg = random.between(0, 360);
    for (int k = 0; k < cards[ring]; ++k) {
      // One random number per statement, because the evaluation order of arguments is unspecified.
      const double heading_deg = turn_deg + 360.0 * k / cards[ring] + random.between(-12, 12);
      const double lift_deg = lifts[ring] + random.between(-8, 8);
      const double reach_m = radius_m * random.between(0.68, 0.86);
      const double half_m = radius_m * random.between(0.5, 0.62);
      add_crown_card(tree, centre, heading_deg, lift_deg, reach_m, half_m, foliage);
    }
  }
}

}  // namespace gigabake::sample
