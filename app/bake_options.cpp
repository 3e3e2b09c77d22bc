#include "app/bake_options.h"

#include <algorithm>
#include <fmt/format.h>

#include "app/choices.h"
#include "app/scene_argument.h"
#include "app/text_values.h"
#include "format/shard/channels.h"
#include "format/system/host_limits.h"
#include "lattice/error.h"

namespace gigabake::app {
namespace {

const Choices<Backend> backends{{{"auto", Backend::automatic}, {"cpu", Backend::cpu}, {"cuda", Backend::cuda}}};
const Choices<SurfaceRule> surfaces{
    {{"area", SurfaceRule::area}, {"conservative", SurfaceRule::conservative}, {"thin", SurfaceRule::thin}}};
const Choices<MipFilter> mips{
    {{"coverage", MipFilter::coverage}, {"thesis", MipFilter::thesis}, {"box", MipFilter::box}}};
const Choices<Codec> codecs{{{"deflate", Codec::deflate}, {"lz4", Codec::lz4}}};
const Choices<UpAxis> up_axes{{{"x", UpAxis::x}, {"y", UpAxis::y}, {"z", UpAxis::z}}};
constexpr std::uint64_t most_usual_memory = std::uint64_t(4) << 30;

double seconds(const char* option, double s, double least) {
  if (s >= least && s <= 1e6) return s;
  throw UsageError(fmt::format("{}: expected {:g} to 1e6 seconds, got {:g}", option, least, s));
}

/// As shards name them, with commas.
void choose_channels(std::string names, BakeParameters& parameters) {
  const std::string asked = names;
  std::replace(names.begin(), names.end(), ',', ' ');
  if (asked.find(' ') != std::string::npos || !parse_channels(names, parameters.normals, parameters.facing))
    throw UsageError("--channels: expected rgba, then perhaps ,normal and ,facing, got '" + asked + "'");
}

}  // namespace

void BakeOptions::add_to(CLI::App& command) {
  command.add_option("SCENE", source, "what to bake: see below")->required();
  command.add_option("--voxel-size", voxel_size, "edge of a voxel at the finest level, metres")->required();
  command.add_option("--surface", surface, "which voxels a triangle occupies (docs/accuracy.md)")
      ->capture_default_str()
      ->check(one_of(surfaces.words()));
  command.add_option("--mip", mip, "filter of coarser levels (docs/accuracy.md)")
      ->capture_default_str()
      ->check(one_of(mips.words()));
  command
      .add_option("--channels", channels,
                  "what voxels say; facing is coverage along x, y and z, which the filter coverage has")
      ->capture_default_str()
      ->check(one_of({"rgba", "rgba,normal", "rgba,facing", "rgba,normal,facing"}));
  command
      .add_option("--max-error", max_error,
                  "how far a voxel may be off, in codes of 255 (normals: chord/2): more is stored once, less exactly")
      ->capture_default_str();
  command.add_option("--codec", codec, "how shards are compressed; lz4 is larger and faster")
      ->capture_default_str()
      ->check(one_of(codecs.words()));
  command.add_option("--cell-voxels", cell_voxels, "edge of a cell in voxels, a power of two from 8 to 8192")
      ->capture_default_str();
  command.add_option("--lattice-origin", lattice_origin,
                     "X,Y,Z: scene position of the lattice's corner, metres (0,0,0)");
  command.add_option("--origin", origin,
                     "LAT,LON,HEIGHT: where the scene frame stands on the earth (the source's own)");
  command.add_flag("--local", local, "no georeference: the source's own frame, turned to z up");
  command.add_option("--up", up, "axis that points up in the source (tilesets z, mesh files y)")
      ->check(one_of(up_axes.words()));
  command.add_option("--threads", threads, "threads of each rank (the host's cores shared by its ranks)");
  command
      .add_option(
          "--memory", memory_bytes,
          "bytes that each rank aims for, as 512M or 4G; 0: no bound (4G, or less where the host, its container "
          "or its batch job has less than twice that for a rank)")
      ->transform(CLI::AsSizeValue(false));
  command.add_option("--backend", backend, "where the kernels run; auto: on a GPU where there is one")
      ->capture_default_str()
      ->check(one_of(backends.words()));
  command.add_option("--gpus", gpus, "devices of each host to use, as 0,2 (all)")->delimiter(',');
  command.add_flag("--json", json, "print the answer as JSON");
}

Backend BakeOptions::wanted_backend() const { return backends.value_of("--backend", backend); }

BakeRequest BakeOptions::request() const {
  expect_source(source);
  BakeRequest r;
  r.source = source;
  r.out = out;
  r.metrics = metrics;
  r.source_options.local = local;
  if (!origin.empty()) r.source_options.origin = geodetic("--origin", origin);
  if (local && !origin.empty()) throw UsageError("--local and --origin contradict each other");
  if (!up.empty()) r.source_options.scene_up = up_axes.value_of("--up", up);
  r.parameters.voxel_size_m = number("--voxel-size", voxel_size);
  if (!lattice_origin.empty())
    r.parameters.lattice_origin_m = triple("--lattice-origin", "X,Y,Z in metres", lattice_origin);
  r.parameters.cell_voxels = cell_voxels;
  r.parameters.surface = surfaces.value_of("--surface", surface);
  r.parameters.mip = mips.value_of("--mip", mip);
  choose_channels(channels, r.parameters);
  r.parameters.max_error = max_error;
  r.parameters.codec = codecs.value_of("--codec", codec);
  check(r.parameters);
  if (threads < 0 || threads > 1024) throw UsageError("--threads: expected 1 to 1024, or 0 for all cores");
  r.threads = threads;
  r.memory_is_usual = !memory_bytes;
  r.memory_bytes = memory_bytes.value_or(usual_memory(most_usual_memory, host_limits().memory_bytes, 1));
  if (memory_bytes.value_or(0) != 0 && *memory_bytes < (std::uint64_t(64) << 20))
    throw UsageError("--memory: expected at least 64M, or 0 for no bound");
  r.keep_going = keep_going;
  r.prune = prune;
  r.stall_s = seconds("--stall", stall_s, 1);
  r.cell_timeout_s = seconds("--cell-timeout", cell_timeout_s, 1);
  r.silence_s = seconds("--silence", silence_s, 5);
  r.backend = wanted_backend();
  r.gpus = gpus;
  return r;
}

}  // namespace gigabake::app
