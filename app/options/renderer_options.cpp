#include "app/options/renderer_options.h"

#include <cmath>
#include <fmt/format.h>

#include "app/options/choices.h"
#include "app/options/text_values.h"
#include "core/base/error.h"
#include "format/system/message.h"

namespace gigabake::app {

void add_light_options(CLI::App& command, LightArguments& a) {
  command.add_option("--exposure", a.exposure_stops, "stops: 1 shows twice the light, -1 half of it")
      ->capture_default_str();
  command
      .add_option("--haze", a.haze,
                  "off, or the distance in metres at which the air transmits a twentieth of the light; only with a sky "
                  "background")
      ->capture_default_str();
}

void add_sun_options(CLI::App& command, SunArguments& a) {
  auto* sun = command.add_option("--sun", a.sun,
                                 "AZIMUTH,ELEVATION of the sun, degrees: clockwise from north, and above the horizon "
                                 "(225,42)");
  command
      .add_option(
          "--time", a.time,
          "time that determines the sun's direction at the scene's location, such as 2026-06-21T15:00Z or with +02:00")
      ->excludes(sun);
  add_choice(command, "--shadows", a.shadows, "shadows of the sun and the sky, in --mode lit");
  add_choice(command, "--level-blend", a.level_blend,
             "whether voxels between two levels are filtered from both, so that nothing pops as the camera moves");
}

void set_light(const LightArguments& a, FrameRenderer::Options& options) {
  if (!(a.exposure_stops >= -16 && a.exposure_stops <= 16)) throw UsageError("--exposure: expected -16 to 16 stops");
  options.exposure_stops = a.exposure_stops;
  if (a.haze == "off") return;
  options.haze_visibility_m = number("--haze", a.haze);
  if (!(options.haze_visibility_m > 0)) throw UsageError("--haze: expected off, or metres above 0, got " + a.haze);
}

namespace {

SunDirection sun_option(const SunArguments& a, const SceneHeader& scene) {
  if (!a.time.empty()) {
    const JulianDay day = julian_day(a.time);
    if (!scene.origin)
      throw UsageError("--time: the scene has no location on the earth; specify --sun AZIMUTH,ELEVATION");
    return sun_at(*scene.origin, day);
  }
  if (a.sun.empty()) return {};
  const std::size_t comma = a.sun.find(',');
  const std::string form = fmt::format("--sun: expected AZIMUTH,ELEVATION in degrees, as 225,42, got '{}'", a.sun);
  if (comma == std::string::npos || a.sun.find(',', comma + 1) != std::string::npos) throw UsageError(form);
  const SunDirection sun{number("--sun", std::string_view(a.sun).substr(0, comma)),
                         number("--sun", std::string_view(a.sun).substr(comma + 1))};
  if (!(std::fabs(sun.azimuth_deg) <= 360 && std::fabs(sun.elevation_deg) <= 90))
    throw UsageError(form + ": an azimuth is within ±360, an elevation within ±90");
  return sun;
}

}  // namespace

void set_sun(const SunArguments& a, const SceneHeader& scene, View& view) {
  view.sun = sun_option(a, scene);
  view.shadows = a.shadows;
  view.level_blend = a.level_blend;
}

void print_sun(const SunArguments& a, const View& view) {
  if (!a.time.empty())
    print_message("gigabake: {}: the sun is at {:.2f}, {:.2f}\n", a.time, view.sun.azimuth_deg, view.sun.elevation_deg);
  if (view.sun.elevation_deg <= 0)
    print_message("gigabake: the sun is {:.1f}° below the horizon: only the sky lights the scene\n",
                  -view.sun.elevation_deg);
}

void add_renderer_options(CLI::App& command, RendererArguments& a) {
  add_choice(command, "--backend", a.backend, "backend that casts rays; auto: a GPU if there is one");
  command.add_option("--threads", a.threads, "CPU threads (all cores)");
  command
      .add_option("--memory", a.memory_bytes,
                  "max bytes of voxels in memory, such as 512M or 4G; 0: half of the host's memory (1G)")
      ->transform(CLI::AsSizeValue(false));
  command.add_option("--gpu-memory", a.device_bytes, "max bytes of voxels in GPU memory (4G)")
      ->transform(CLI::AsSizeValue(false));
}

FrameRenderer::Options renderer_options(const RendererArguments& a) {
  if (a.threads < 0 || a.threads > 1024) throw UsageError("--threads: expected 1 to 1024, or 0 for all cores");
  FrameRenderer::Options options;
  options.threads = a.threads;
  options.memory_bytes = a.memory_bytes != 0 ? a.memory_bytes : UINT64_MAX;
  options.device_bytes = a.device_bytes;
  options.device_required = a.backend == Backend::cuda;
  options.cuda_device = choose_device({a.backend}).device;
  return options;
}

}  // namespace gigabake::app
