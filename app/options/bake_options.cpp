#include "app/options/bake_options.h"

#include <algorithm>
#include <fmt/format.h>

#include "app/options/choices.h"
#include "app/options/scene_argument.h"
#include "app/options/text_values.h"
#include "core/base/error.h"
#include "format/shard/columns/channels.h"
#include "format/system/host_limits.h"

namespace gigabake::app {
namespace {

constexpr std::uint64_t max_default_memory = std::uint64_t(4) << 30;

void expect_seconds(const char* option, double s, double minimum) {
  if (s >= minimum && s <= 1e6) return;
  throw UsageError(fmt::format("{}: expected {:g} to 1e6 seconds, got {:g}", option, minimum, s));
}

/// Returns the channel names with commas; shards separate them by spaces.
std::string with_commas(std::string names) {
  std::replace(names.begin(), names.end(), ' ', ',');
  return names;
}

void choose_channels(std::string names, BakeParameters& parameters) {
  const std::string given = names;
  std::replace(names.begin(), names.end(), ',', ' ');
  const auto channels = given.find(' ') == std::string::npos ? parse_channels(names) : std::nullopt;
  if (!channels || channels->classes)
    throw UsageError("--channels: expected rgba, optionally followed by ,normal and ,facing, got '" + given + "'");
  parameters.normals = channels->normals, parameters.directional_coverage = channels->directional_coverage;
}

std::vector<std::string> all_channels() {
  std::vector<std::string> all;
  for (const bool has_directional_coverage : {false, true})
    for (const bool has_normals : {false, true})
      all.push_back(with_commas(channel_names({has_normals, has_directional_coverage})));
  return all;
}

}  // namespace

BakeOptions::BakeOptions()
    : channels(with_commas(channel_names({asked.parameters.normals, asked.parameters.directional_coverage}))) {}

void BakeOptions::add_to(CLI::App& command) {
  BakeParameters& p = asked.parameters;
  command.add_option("SOURCE", source, "input of the bake: see below")->required();
  command.add_option("--voxel-size", voxel_size, "edge of a voxel at the finest level, metres")->required();
  add_choice(command, "--surface", p.surface, "which voxels a triangle occupies (docs/accuracy.md)");
  add_choice(command, "--mip", p.mip, "filter of coarser levels (docs/accuracy.md)");
  command
      .add_option("--channels", channels,
                  "attributes of voxels; facing: coverage along x, y and z, which only the filter coverage computes")
      ->capture_default_str()
      ->check(one_of(all_channels()));
  command
      .add_option("--max-error", p.max_error,
                  "max error of a voxel, in codes of 255 (normals: chord/2); larger values store less exact voxels in "
                  "fewer bytes")
      ->capture_default_str();
  command
      .add_option("--depth-error", p.depth_error,
                  "max error of a coarser voxel that is stored in place of finer ones, in codes of 255 (positions: "
                  "eighths of a voxel); larger values store fewer voxels; 0: only equal voxels; bakes on the CPU")
      ->capture_default_str();
  add_choice(command, "--codec", p.codec, "compression of shards; lz4 is larger and faster");
  command.add_option("--cell-voxels", p.cell_voxels, "edge of a cell in voxels, a power of two from 8 to 8192")
      ->capture_default_str();
  command.add_option("--lattice-origin", lattice_origin,
                     "X,Y,Z: position of the lattice's corner in the scene, metres (0,0,0)");
  command.add_option("--origin,--origin-lat-lon", origin,
                     "LAT,LON,HEIGHT: origin of the scene on the earth (the source's origin)");
  command.add_flag("--local", asked.source_options.local, "no georeference: use the source's frame, rotated to z up");
  add_choice(command, "--up", asked.source_options.scene_up,
             "axis that points up in the source (tilesets z, mesh files y)");
  raster.add_to(command);
  area.add_to(command);
  command.add_option("--threads", asked.threads, "threads of each rank (the host's cores shared by its ranks)");
  command
      .add_option("--memory", memory_bytes,
                  "target for the memory of each rank, and of its GPU, such as 512M or 4G; 0: no bound (4G, or less if "
                  "the host, its container or its batch job has less than twice that per rank; three quarters of a "
                  "GPU, shared by its ranks)")
      ->transform(CLI::AsSizeValue(false));
  command.add_option("--scratch", asked.scratch,
                     "folder for temporary copies of tiles and textures that need more than a 128th of --memory (bake: "
                     "SCENE/scratch; plan: the system's temporary folder)");
  add_choice(command, "--backend", asked.backend, "backend of the kernels; auto: a GPU if there is one");
  command.add_option("--gpus", asked.gpus, "GPUs of each host to use, such as 0,2 (all)")->delimiter(',');
  command.add_flag("--json", json, "print the answer as JSON");
}

BakeRequest BakeOptions::request_of(MpiSession& mpi) const {
  BakeRequest own;
  check_options_collectively(mpi, [&] {
    if (mpi.rank() == 0)
      expect_source(source);  // the path is checked on rank 0 only, because other ranks may have
                              // another working directory
    own = checked_request();
    if (mpi.rank() != 0) return;  // only rank 0 opens the source
    own.source_options.raster = raster.options();
    own.source_options.area = area.area();
  });
  return own;
}

BakeRequest BakeOptions::request() const {
  expect_source(source);
  BakeRequest own = checked_request();
  own.source_options.raster = raster.options();
  own.source_options.area = area.area();
  return own;
}

BakeRequest BakeOptions::checked_request() const {
  BakeRequest r = asked;
  r.source = source;
  r.out = out;
  r.metrics = metrics;
  r.area_text = area.text();
  r.raster_text = raster.text();
  if (!origin.empty()) r.source_options.origin = geodetic("--origin", origin);
  if (r.source_options.local && !origin.empty()) throw UsageError("--local and --origin contradict each other");
  r.parameters.voxel_size_m = number("--voxel-size", voxel_size);
  if (!lattice_origin.empty())
    r.parameters.lattice_origin_m = triple("--lattice-origin", "X,Y,Z in metres", lattice_origin);
  choose_channels(channels, r.parameters);
  check(r.parameters);
  if (r.threads < 0 || r.threads > 1024) throw UsageError("--threads: expected 1 to 1024, or 0 for all cores");
  r.is_default_memory = !memory_bytes;
  r.memory_bytes = memory_bytes.value_or(default_memory(max_default_memory, host_limits().memory_bytes, 1));
  if (memory_bytes.value_or(0) != 0 && *memory_bytes < (std::uint64_t(64) << 20))
    throw UsageError("--memory: expected at least 64M, or 0 for no bound");
  expect_seconds("--stall", r.timeouts.no_progress_s, 1);
  expect_seconds("--cell-timeout", r.timeouts.cell_timeout_s, 1);
  expect_seconds("--silence", r.timeouts.heartbeat_timeout_s, 5);
  return r;
}

}  // namespace gigabake::app
