// A custom shader: contour lines at a distance of STEP_M metres, drawn over the lit scene.
//
//     `contour_lines SCENE/scene.xml STEP_M PICTURE.png`    prints the number of pixels of surfaces and of lines
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "core/base/error.h"
#include "kernels/light/shader.h"
#include "viewer/light/sky.h"
#include "viewer/pictures/frame_renderer.h"
#include "viewer/pictures/image_files.h"

namespace {

/// Shader that returns black within a tenth of a step above each multiple of the step. Lengths are in voxels.
struct ContourShader {
  gigabake::kernels::LitShader lit;
  double step = 1;

  GB_HD void operator()(const gigabake::kernels::SurfacePoint& at, float rgb[3]) const {
    lit(at, rgb);
    const double steps = at.place[2] / step, part = steps - std::floor(steps);
    for (int k = 0; k < 3 && part < 0.1; ++k) rgb[k] = 0;
  }
};

int draw(const char* scene, double step_m, const char* file) {
  using namespace gigabake;
  FrameRenderer renderer(scene, {});
  View view;
  view.camera.width = view.camera.height = 96;
  view.background = {false, {0, 0, 0, 0}};
  const ContourShader shader{{gigabake::daylight(view.sun)}, step_m / renderer.scene().header().voxel_size_m};
  view.shader = kernels::host_shader(shader);
  const Picture picture = renderer.render_complete(view).picture;
  write_png(file, picture);
  int surface = 0, lines = 0;
  for (std::size_t i = 0; i < picture.rgba.size(); i += 4) {
    if (picture.rgba[i + 3] != 255) continue;
    ++surface;
    if (picture.rgba[i] + picture.rgba[i + 1] + picture.rgba[i + 2] == 0) ++lines;
  }
  std::printf("%d %d\n", surface, lines);
  return EXIT_SUCCESS;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 4 || !(std::atof(argv[2]) > 0)) {
    std::fprintf(stderr, "usage: contour_lines SCENE/scene.xml STEP_M PICTURE.png\n");
    return EXIT_FAILURE;
  }
  try {
    return draw(argv[1], std::atof(argv[2]), argv[3]);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "contour_lines: %s\n", e.what());
    return EXIT_FAILURE;
  }
}
