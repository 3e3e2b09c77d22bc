/// Scenes with what real scenes contain and closed forms describe: houses without ground, wires, leaves, thin walls.
/// None is aligned with the lattice. Closed solids are wound outwards.
///
/// Space   Lod-0 voxels of a lattice at the scene's origin, z up; voxels are 1 m wide.
#pragma once

#include <string>
#include <vector>

#include "bench/hard/surfaces/silhouette.h"
#include "sample/glb_writer.h"

namespace gigabake::bench {

struct SurfaceScene {
  std::string name, what;
  sample::GlbModel model;
  std::vector<ConvexBody> bodies;  ///< the solids and flat pieces of the scene, all opaque and grey
};

/// The linear albedo of all scenes.
inline constexpr double surface_albedo = 0.3;

/// Returns houses of 12 to 32 voxels without ground. Each has walls, a saddle roof and a floor of one layer.
SurfaceScene town_scene();

/// Returns square bars of a thickness in voxels: some level, some upright.
SurfaceScene thin_wires_scene(double thickness);

enum class LeafShape {
  sheet,  ///< one layer, seen from both sides
  solid,  ///< a closed box, a tenth of its edge thick
};
/// Returns square leaves with random directions. They cover about 5 % of the image.
SurfaceScene leaves_scene(LeafShape shape, double edge);

/// A solid wall that leans from upright by `lean_deg`. The normal is a unit vector; the wall's middle is `middle`.
struct WallScene : SurfaceScene {
  Vec3d normal{}, along{}, middle{};
  double length = 192, height = 96, thickness = 0;
};
WallScene thin_wall_scene(double thickness, double azimuth_deg, double lean_deg);

/// A closed house, and a point inside.
struct HouseScene : SurfaceScene {
  Vec3d inside{};
};
/// Returns a house whose walls, roof and floor are `thickness` voxels thick; 0: one layer.
HouseScene closed_house_scene(double thickness, double azimuth_deg);

}  // namespace gigabake::bench
