#include "app/options/renderer_options.h"

#include "app/options/choices.h"
#include "app/options/text_values.h"
#include "lattice/error.h"

namespace gigabake::app {

void add_light_options(CLI::App& command, LightArguments& a) {
  command.add_option("--exposure", a.exposure_stops, "stops: 1 shows twice the light, -1 half of it")
      ->capture_default_str();
  command
      .add_option("--haze", a.haze, "off, or metres at which the air leaves a twentieth of what is there; before a sky")
      ->capture_default_str();
}

void set_light(const LightArguments& a, FrameRenderer::Options& options) {
  if (!(a.exposure_stops >= -16 && a.exposure_stops <= 16)) throw UsageError("--exposure: expected -16 to 16 stops");
  options.exposure_stops = a.exposure_stops;
  if (a.haze == "off") return;
  options.haze_visibility_m = number("--haze", a.haze);
  if (!(options.haze_visibility_m > 0)) throw UsageError("--haze: expected off, or metres above 0, got " + a.haze);
}

void add_renderer_options(CLI::App& command, RendererArguments& a) {
  add_choice(command, "--backend", a.backend, "where rays are cast; auto: on a GPU where there is one");
  command.add_option("--threads", a.threads, "CPU threads (all cores)");
  command.add_option("--memory", a.memory_bytes, "bytes of voxels to hold, as 512M or 4G; 0: half of the host's (1G)")
      ->transform(CLI::AsSizeValue(false));
  command.add_option("--gpu-memory", a.device_bytes, "bytes of voxels to hold on a GPU besides (4G)")
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
