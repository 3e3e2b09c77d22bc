// Cuts a baked scene open along a plane, and measures the ground's height under its middle.
// Prints the pixels of the whole scene, the pixels of the remaining half, and the height in metres.
#include <core/octree/parameters.h>
#include <cstdio>
#include <exception>
#include <query/query_frames.h>
#include <query/scene_query.h>
#include <query/surface_height.h>
#include <viewer/pictures/frame_renderer.h>
#include <viewer/pictures/image_files.h>

namespace {

using namespace gigabake;

int pixels_of(FrameRenderer& renderer, const Clip& clip, const char* png) {
  View view;
  view.camera.width = view.camera.height = 96;
  view.camera.clip = clip;
  view.background = {false, {0, 0, 0, 0}};
  const Picture picture = renderer.render_complete(view).picture;
  write_png(png, picture);
  int pixels = 0;
  for (std::size_t i = 3; i < picture.rgba.size(); i += 4) pixels += picture.rgba[i] > 0 ? 1 : 0;
  return pixels;
}

}  // namespace

int main(int arguments, char** argument) {
  if (arguments != 3) return 2;
  try {
    FrameRenderer renderer(argument[1], {});
    Clip west_half;
    west_half.plane = ClipPlane{{0, 0, 0}, {-1, 0, 0}};
    const int whole = pixels_of(renderer, {}, argument[2]), half = pixels_of(renderer, west_half, argument[2]);

    const ThreadPool pool(2);
    SceneQuery query(std::make_shared<const PagedScene>(argument[1]), {}, pool);
    const QueryFrames frames(query.scene().header(), query.window(), QueryFrame::scene);
    const QueryRay ray = frames.down(0, 0);
    QueryHit hit;
    query.first_hits({&ray, 1}, {&hit, 1});
    if (hit.outcome != QueryOutcome::hit) return 1;
    // A ray ends where it enters a voxel's cube. The ground lies somewhere in the cube.
    move_to_surface(query, parameters_from_json(query.scene().header().parameters).surface, {&ray, 1}, {&hit, 1});
    std::printf("%d %d %.3f\n", whole, half, frames.scene_point(ray, hit.distance).z);
    return 0;
  } catch (const std::exception& e) {
    std::fprintf(stderr, "%s\n", e.what());
    return 1;
  }
}
