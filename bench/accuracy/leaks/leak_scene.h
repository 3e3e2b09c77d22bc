/// Scenes of which it is known what alpha every pixel must have: planes, hills, steps, walls, a house, panes, wires and
/// a crown. None of them lies along the lattice.
///
/// Space   Lod-0 voxels of a lattice at the scene's origin, z up; voxels are 1 m wide, so files have the same numbers.
#pragma once

#include <string>
#include <vector>

#include "bench/accuracy/leaks/sheet.h"
#include "format/sample/glb_writer.h"

namespace gigabake::bench {

enum class LeakTruth {
  sheets,  ///< alpha is that of the sheets that a ray crosses
  traced,  ///< alpha is what ReferenceCaster sees; the sheets say only where the inside is
};

struct LeakScene {
  std::string name, family;  ///< "plane-20-at-161", of the family "planes"
  std::string what;
  sample::GlbModel model;
  std::vector<Sheet> sheets;
  double sheet_alpha = 1;
  LeakTruth truth = LeakTruth::sheets;
  Vector target{};   ///< where cameras look: on the surface, in its middle
  double width = 0;  ///< of its inside, at the least where it is seen in full
};

/// Of a plane with this slope, that falls towards the azimuth.
LeakScene plane_scene(double edge, double slope_deg, double azimuth_deg);
/// A hill of waves, 0 at the border of its square and nowhere below: so a ray that meets the square meets the hill.
LeakScene hill_scene(double edge);
/// A stair of level and upright faces.
LeakScene steps_scene(const std::string& name, double edge, double tread, double rise);
/// A wall that is one sheet, or the four sides of a solid one of that thickness and its top.
LeakScene wall_scene(const std::string& name, double edge, double thickness);
/// Four walls and a saddle roof with eaves over them; open at the bottom, so that nothing hides behind a hole.
LeakScene house_scene(double edge);
/// Parallel panes that each let 70 % through.
LeakScene pane_scene(const std::string& name, double edge, double slope_deg, int layers);
/// Square bars, 2.6 voxels thick and 19.4 apart, in two directions.
LeakScene wires_scene(double edge);
/// Small triangles at random places and directions in a ball.
LeakScene crown_scene(double edge);

/// All of them; edge: how wide each is, in voxels.
std::vector<LeakScene> leak_scenes(double edge);
/// Three opaque planes: what `--hard` looks at.
std::vector<LeakScene> few_leak_planes(double edge);

}  // namespace gigabake::bench
