/// The orbit that flights of benchmarks follow, and the part of a scene that it surrounds.
#pragma once

#include <vector>

#include "viewer/pictures/view.h"

namespace gigabake::bench {

/// The middle and the width of a scene, and the height of its ground.
struct FlightArea {
  Point<Scene> middle_m;
  double width_m = 0, ground_m = 0, voxel_m = 0;
};

View view_from(const Point<Scene>& eye_m, const Point<Scene>& target_m, int width, int height);

/// Returns a view of the orbit around the middle. `angle` is in radians, 2π is the whole orbit. The radius is .4 of the
/// width. The eye is .05 to .25 of the width above the ground and reaches each height three times per orbit.
View orbit_view(const FlightArea& area, double angle, int width, int height);

/// Returns the length of the orbit.
double orbit_length_m(const FlightArea& area);

/// Returns the angles of the eye on one orbit if it moves `step_m` along the orbit per frame. The first angle is 0.
/// Range   step_m > 0. At most one frame per 2^20th of the orbit.
std::vector<double> orbit_angles(const FlightArea& area, double step_m);

}  // namespace gigabake::bench
