#include "viewer/pictures/view_needs.h"

namespace gigabake {

std::optional<kernels::CastLightPart> light_part_of(const View& view) {
  switch (view.mode) {
    case ViewMode::lit:
      if (view.shadows == Shadows::on) return kernels::CastLightPart::all;
      if (view.shader) return kernels::CastLightPart::unshadowed;
      return {};
    case ViewMode::sun:
      return kernels::CastLightPart::sun;
    case ViewMode::sky:
      return kernels::CastLightPart::sky;
    case ViewMode::shadow:
      return kernels::CastLightPart::shadow;
    case ViewMode::height:
    case ViewMode::slope:
      return kernels::CastLightPart::unshadowed;
    default:
      return {};
  }
}

Filling filling_of(const View& view) {
  if (light_part_of(view)) return {Surface::colour};
  switch (view.mode) {
    case ViewMode::albedo:
      return {Surface::colour};
    case ViewMode::normal:
      return {Surface::normal};
    case ViewMode::coverage:
      return {Surface::coverage};
    case ViewMode::voxel_class:
      return {Surface::voxel_class};
    case ViewMode::cell:
      return {Surface::colour, SunDirection{}, true};
    case ViewMode::lit:
      return {Surface::colour, view.sun};
    default:
      return {Surface::colour, SunDirection{}};
  }
}

bool shows_light(ViewMode mode) { return mode == ViewMode::lit || mode == ViewMode::sun || mode == ViewMode::sky; }

kernels::DebugColor debug_color_of(ViewMode mode) {
  switch (mode) {
    case ViewMode::lod:
      return kernels::DebugColor::lod;
    case ViewMode::cell:
      return kernels::DebugColor::cell;
    case ViewMode::requests:
      return kernels::DebugColor::waits;
    default:
      return kernels::DebugColor::shaded;
  }
}

std::shared_ptr<const kernels::SurfaceShader> shader_of(const View& view, const HeightRange& heights) {
  switch (view.mode) {
    case ViewMode::lit:
      return view.shader;
    case ViewMode::height:
      return kernels::height_shader({heights.low, heights.high});
    case ViewMode::slope:
      return kernels::slope_shader({});
    default:
      return {};
  }
}

bool same_picture(const View& a, const View& b) {
  const CameraOptions &c = a.camera, &d = b.camera;
  return a.mode == b.mode && c.eye_m == d.eye_m && c.target_m == d.target_m && c.up == d.up &&
         c.fovy_deg == d.fovy_deg && c.width == d.width && c.height == d.height && c.pixel_error == d.pixel_error &&
         a.sun == b.sun && a.shadows == b.shadows && a.level_blend == b.level_blend && a.shader == b.shader &&
         a.polygons == b.polygons && c.clip == d.clip && c.eye_m.has_value();
}

kernels::CastPolygons PolygonPictures::drawn(const View& view, const kernels::CastCamera& camera,
                                             const SceneHeader& scene, const kernels::CastHaze& haze,
                                             const ThreadPool& policy) {
  if (!same_picture(view, of_) || view.background.sky != of_.background.sky) {
    const kernels::CastLight light = shows_light(view.mode) ? daylight(view.sun) : kernels::unlit();
    kernels::CastCamera without = camera;
    without.polygons = {};
    picture_ = draw_polygons(*view.polygons, scene, without, light, haze, policy);
    of_ = view;
  }
  return picture_.view();
}

}  // namespace gigabake
