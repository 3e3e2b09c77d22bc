/// Scenes with a known alpha at every pixel: planes, hills, steps, walls, a house, glass, wires, a crown, and planes
/// under plants, decals and glass. None of them is aligned with the lattice.
///
/// Space   Lod-0 voxels of a lattice at the scene's origin, z up. Voxels are 1 m wide, so coordinates in files have the
///         same values.
#pragma once

#include <string>
#include <vector>

#include "bench/accuracy/leaks/sheet.h"
#include "sample/glb_writer.h"

namespace gigabake::bench {

enum class LeakReferenceKind {
  sheets,  ///< alpha of the flat pieces (`Sheet`) that a ray crosses
  traced,  ///< alpha is traced by ReferenceCaster; the flat pieces define only the inside
};

struct LeakScene {
  std::string name, family;  ///< "plane-20-at-161", of the family "planes"
  std::string what;
  sample::GlbModel model;
  std::vector<Sheet> sheets;
  double sheet_alpha = 1;
  LeakReferenceKind reference_alpha = LeakReferenceKind::sheets;
  Vec3d target{};    ///< point at which cameras look: in the middle of the surface
  double width = 0;  ///< minimum width of the scene's inside in views that show the scene completely
};

/// Returns a plane with slope `slope_deg` that descends towards the azimuth.
LeakScene plane_scene(double edge, double slope_deg, double azimuth_deg);
/// Returns a hill with waves over a square. Its height is 0 at the border of the square and never negative, so every
/// ray that hits the square hits the hill.
LeakScene hill_scene(double edge);
/// Returns stairs of horizontal and vertical faces.
LeakScene steps_scene(const std::string& name, double edge, double tread, double rise);
/// Returns a solid wall with six sides, or a wall of one flat piece if `thickness` is 0.
LeakScene wall_scene(const std::string& name, double edge, double thickness);
/// Returns four walls and a saddle roof with eaves. The house has no floor, so a vertical ray through
/// a leak in the roof hits nothing else.
LeakScene house_scene(double edge);
/// Returns parallel translucent surfaces, each with a transmittance of 70 %.
LeakScene pane_scene(const std::string& name, double edge, double slope_deg, int layers);
/// Returns square bars in two directions, 2.6 voxels thick and 19.4 apart.
LeakScene wires_scene(double edge);
/// Returns small triangles in a ball, at random places and in random directions.
LeakScene crown_scene(double edge);
/// Returns a plane with alpha-tested cards on it: upright blades, or leaves that lie on it.
LeakScene plants_scene(double edge, double slope_deg, bool upright);
/// Returns a plane with a layer 0.2 voxels before it: glass of alpha .3, or a decal whose mask cuts away all of it.
LeakScene layer_scene(double edge, double slope_deg, bool is_glass);

/// Returns the scene with half of its triangles, chosen at random, wound the other way.
LeakScene mixed_winding(LeakScene scene);

/// Returns all scenes. `edge` is the width of each scene in voxels.
std::vector<LeakScene> leak_scenes(double edge);
/// Returns three opaque planes, as `--hard` measures them.
std::vector<LeakScene> few_leak_planes(double edge);

}  // namespace gigabake::bench
