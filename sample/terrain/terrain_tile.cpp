#include "sample/terrain/terrain_tile.h"

#include <algorithm>
#include <cmath>

#include "sample/terrain/skin.h"

namespace gigabake::sample {
namespace {

constexpr double grid_per_m = 1024;
constexpr int wall_tints = 4, roof_tints = 3;
constexpr std::array<double, 4> wall_colours[wall_tints] = {
    {0.95, 0.93, 0.88, 1}, {0.93, 0.80, 0.55, 1}, {0.80, 0.46, 0.34, 1}, {0.72, 0.78, 0.80, 1}};
constexpr std::array<double, 4> roof_colours[roof_tints] = {{1, 1, 1, 1}, {0.62, 0.62, 0.66, 1}, {0.78, 0.55, 0.45, 1}};

double on_grid(double m) { return std::floor(m * grid_per_m + 0.5) / grid_per_m; }

/// Indices of meshes, in the order of the materials.
enum MeshSlot : std::size_t {
  ground,
  bark,
  foliage,
  first_wall,
  first_roof = first_wall + wall_tints,
  slots = first_roof + roof_tints
};

class TileBuilder {
 public:
  TileBuilder(const Landscape& landscape, const TileFrame& frame, const TilePlan& plan, const GlbImage& painted)
      : landscape_(landscape), frame_(frame), plan_(plan), painted_(painted) {
    const MapPoint middle{plan.min.e_m + plan.size_m.e_m / 2, plan.min.n_m + plan.size_m.n_m / 2};
    origin_ = frame.place(middle, 0);
    out_.model.meshes.resize(slots);
    for (std::size_t i = 0; i < slots; ++i) out_.model.meshes[i].material = int(i);
    out_.model.translation_m = {origin_[0], origin_[2], -origin_[1]};
  }

  TerrainTile build() {
    add_ground();
    if (plan_.with_objects) add_objects();
    add_materials();
    measure();
    return std::move(out_);
  }

 private:
  Corner local(MapPoint p, double height_m) const {
    const Vec3d at = frame_.place(p, height_m) - origin_;
    return {at[0], at[1], at[2]};
  }
  MapPoint grid_point(int x, int y) const {
    return {plan_.min.e_m + plan_.size_m.e_m * x / plan_.quads.e, plan_.min.n_m + plan_.size_m.n_m * y / plan_.quads.n};
  }

  void add_ground() {
    GlbMesh& mesh = out_.model.meshes[ground];
    const GridSize quads = plan_.quads;
    for (int y = 0; y <= quads.n; ++y)
      for (int x = 0; x <= quads.e; ++x) {
        const MapPoint p = grid_point(x, y);
        const Corner c = local(p, landscape_.relief.height_m(p));
        mesh.position.insert(mesh.position.end(), {float(c.e_m), float(c.u_m), float(-c.n_m)});
        mesh.uv.push_back(std::uint16_t(65535.0 * x / quads.e + 0.5));
        mesh.uv.push_back(std::uint16_t(65535.0 * (quads.n - y) / quads.n + 0.5));
      }
    const int points = quads.e + 1;
    for (int y = 0; y < quads.n; ++y)
      for (int x = 0; x < quads.e; ++x) {
        const auto a = std::uint32_t(y * points + x), b = a + 1, c = a + std::uint32_t(points), d = c + 1;
        // Diagonals alternate, so that no direction of the ground is favoured.
        if ((x + y) % 2 == 0)
          mesh.index.insert(mesh.index.end(), {a, b, d, a, d, c});
        else
          mesh.index.insert(mesh.index.end(), {a, b, c, b, d, c});
      }
  }

  void add_objects() {
    const MapPoint max{plan_.min.e_m + plan_.size_m.e_m, plan_.min.n_m + plan_.size_m.n_m};
    for (const House& h : landscape_.settlement.houses()) {
      const MapPoint p = h.centre;
      if (p.e_m >= plan_.min.e_m && p.e_m < max.e_m && p.n_m >= plan_.min.n_m && p.n_m < max.n_m) place_house(h);
    }
    for (const Tree& tree : landscape_.settlement.trees_in(plan_.min, max)) {
      add_tree(tree, local(tree.foot, landscape_.relief.height_m(tree.foot)), out_.model.meshes[bark],
               out_.model.meshes[foliage]);
      ++out_.trees;
    }
  }

  void place_house(const House& h) {
    const Turn t = turn_of(h.heading_deg);
    double lowest_m = 1e9, highest_m = -1e9;
    for (const double x : {-0.5, 0.5})
      for (const double y : {-0.5, 0.5}) {
        const double dx = x * h.length_m, dy = y * h.depth_m;
        const double height_m = landscape_.relief.height_m(
            {h.centre.e_m + dx * t.cosine - dy * t.sine, h.centre.n_m + dx * t.sine + dy * t.cosine});
        lowest_m = std::min(lowest_m, height_m);
        highest_m = std::max(highest_m, height_m);
      }
    const double floor_m = 0.5 * (lowest_m + highest_m) + 0.2;
    const Corner floor = local(h.centre, floor_m);
    add_house(h, {floor.e_m, floor.n_m}, floor.u_m - (floor_m - lowest_m) - 1, floor.u_m,
              out_.model.meshes[first_wall + std::size_t(h.wall_tint)],
              out_.model.meshes[first_roof + std::size_t(h.roof_tint)]);
    ++out_.houses;
  }

  int add_image(const GlbImage& image) {
    out_.model.images.push_back(image);
    return int(out_.model.images.size()) - 1;
  }

  void add_materials() {
    auto& m = out_.model.materials;
    m.push_back({"ground", add_image(painted_), {1, 1, 1, 1}, 0, false});
    m.push_back({"bark", -1, {0.11, 0.075, 0.05, 1}, 0, false});
    const int leaves = out_.trees == 0 ? -1 : add_image(landscape_.kit.foliage);
    m.push_back({"foliage", leaves, {1, 1, 1, 1}, 0.5, true});
    const int facade = out_.houses == 0 ? -1 : add_image(landscape_.kit.facade);
    const int tiles = out_.houses == 0 ? -1 : add_image(landscape_.kit.roof);
    for (const auto& colour : wall_colours) m.push_back({"wall", facade, colour, 0, false});
    for (const auto& colour : roof_colours) m.push_back({"roof", tiles, colour, 0, true});
  }

  void measure() {
    out_.min_m = Vec3d::all(1e9);
    out_.max_m = Vec3d::all(-1e9);
    for (const GlbMesh& mesh : out_.model.meshes) {
      out_.triangles += mesh.index.size() / 3;
      for (std::size_t i = 0; i < mesh.position.size(); i += 3) {
        const float* p = &mesh.position[i];
        const Vec3d at = origin_ + Vec3d{p[0], -p[2], p[1]};
        out_.min_m = min_by_axis(out_.min_m, at);
        out_.max_m = max_by_axis(out_.max_m, at);
      }
    }
  }

  const Landscape& landscape_;
  const TileFrame& frame_;
  const TilePlan& plan_;
  const GlbImage& painted_;
  Vec3d origin_{};
  TerrainTile out_;
};

}  // namespace

Landscape::Landscape(double size_m, std::uint32_t seed_)
    : seed(seed_), relief(size_m, seed_), settlement(relief, seed_), kit(paint_kit(seed_)) {}

Vec3d TileFrame::place(MapPoint p, double height_m) const {
  if (earth == nullptr) return {on_grid(p.e_m), on_grid(p.n_m), on_grid(height_m)};
  const Point<Enu> at = earth->enu(p, height_m);
  return {on_grid(at.x), on_grid(at.y), on_grid(at.z)};
}

GlbImage paint_tile(const Landscape& l, const TilePlan& plan) {
  const Picture picture = paint_ground(l.relief, l.settlement, l.seed, plan.min, plan.size_m, plan.texels);
  return {"image/jpeg", to_jpeg(picture, jpeg_quality)};
}

TerrainTile make_tile(const Landscape& landscape, const TileFrame& frame, const TilePlan& plan,
                      const GlbImage& ground) {
  return TileBuilder(landscape, frame, plan, ground).build();
}

}  // namespace gigabake::sample
