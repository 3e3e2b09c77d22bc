#include "app/options/live_options.h"

#include "app/options/text_values.h"
#include "core/base/error.h"

namespace gigabake::app {

void add_live_options(CLI::App& command, LiveArguments& a) {
  command.add_option("SCENE", a.scene, "folder of a bake, or its scene.xml")->required();
  command.add_option("--eye", a.eye, "X,Y,Z: initial camera, scene metres (south-east of the target, all in view)");
  command.add_option("--target", a.target, "X,Y,Z: point that the camera initially faces (the middle of the scene)");
  command.add_option("--fovy", a.fovy_deg, "vertical field of view, degrees")->capture_default_str();
  command.add_option("--pixel-error", a.pixel_error, "max width of a voxel in pixels")->capture_default_str();
  command.add_option("--frame-ms", a.frame_ms, "target milliseconds per frame while the camera moves")
      ->capture_default_str();
  add_light_options(command, a.light);
  add_sun_options(command, a.sun);
  add_renderer_options(command, a.renderer);
}

LiveScene::Options live_options(const LiveArguments& a) {
  if (!(a.fovy_deg >= 0.01 && a.fovy_deg <= 170)) throw UsageError("--fovy: expected 0.01 to 170 degrees");
  check_pixel_error(a.pixel_error);
  if (!(a.frame_ms >= 1 && a.frame_ms <= 10000)) throw UsageError("--frame-ms: expected 1 to 10000 milliseconds");
  LiveScene::Options out;
  out.renderer = renderer_options(a.renderer);
  set_light(a.light, out.renderer);
  out.camera.eye_m = point_option(a.eye, "--eye");
  out.camera.target_m = point_option(a.target, "--target");
  out.camera.fovy_deg = a.fovy_deg;
  out.camera.pixel_error = a.pixel_error;
  out.frame_s = a.frame_ms / 1000;
  out.look = [sun = a.sun](const SceneHeader& scene) {
    View view;
    set_sun(sun, scene, view);
    ViewerInput first;
    first.sun = {view.sun.azimuth_deg, view.sun.elevation_deg};
    first.shadows = view.shadows;
    first.level_blend = view.level_blend;
    return first;
  };
  return out;
}

}  // namespace gigabake::app
