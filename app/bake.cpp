#include <fmt/format.h>
#include <memory>
#include <nlohmann/json.hpp>
#include <sys/resource.h>

#include "app/bake_options.h"
#include "app/commands.h"
#include "app/progress.h"
#include "format/error.h"

namespace gigabake::app {
namespace {

std::uint64_t peak_process_bytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return std::uint64_t(usage.ru_maxrss) * 1024;
}

/// Totals over the scene's cells.
struct Totals {
  std::uint64_t voxels = 0, finest_voxels = 0, bytes = 0;
  explicit Totals(const SceneDescription& scene) {
    for (const SceneCell& c : scene.cells) {
      for (const std::uint64_t v : c.voxels) voxels += v;
      if (!c.voxels.empty()) finest_voxels += c.voxels[0];
      bytes += c.bytes;
    }
  }
};

const char* slowest_stage(const BakeSummary& s) {
  if (s.read_s >= s.kernel_s && s.read_s >= s.write_s) return "read";
  return s.kernel_s >= s.write_s ? "kernels" : "write";
}

void print_text(const BakeSummary& s, const std::filesystem::path& out) {
  const Totals t(s.scene);
  fmt::print("{} cells ({} empty), {} triangles, {} voxels at lod 0, {} in all, {} on disk\n", s.scene.cells.size(),
             s.cells_empty, s.scene.triangles, t.finest_voxels, t.voxels, readable_bytes(t.bytes));
  fmt::print(
      "survey {:.2f} s, bake {:.2f} s on {} ranks × {} threads; stages read {:.2f} s, kernels {:.2f} s, write {:.2f} "
      "s: {} sets "
      "the pace\n",
      s.survey_s, s.bake_s, s.ranks, s.threads, s.read_s, s.kernel_s, s.write_s, slowest_stage(s));
  fmt::print("peak memory {} (kernels {})\n", readable_bytes(peak_process_bytes()),
             readable_bytes(s.peak_kernel_bytes));
  fmt::print("{}\n", (out / "scene.xml").string());
}

void print_json(const BakeSummary& s, const std::filesystem::path& out) {
  const Totals t(s.scene);
  nlohmann::ordered_json j;
  j["scene"] = (out / "scene.xml").string();
  j["cells"] = s.scene.cells.size();
  j["cells_planned"] = s.cells_planned;
  j["cells_empty"] = s.cells_empty;
  j["triangles"] = s.scene.triangles;
  j["voxels_lod0"] = t.finest_voxels;
  j["voxels"] = t.voxels;
  j["bytes"] = t.bytes;
  j["ranks"] = s.ranks;
  j["threads"] = s.threads;
  j["seconds"] = {
      {"survey", s.survey_s}, {"bake", s.bake_s}, {"read", s.read_s}, {"kernels", s.kernel_s}, {"write", s.write_s}};
  j["slowest_stage"] = slowest_stage(s);
  j["peak_process_bytes"] = peak_process_bytes();
  j["peak_kernel_bytes"] = s.peak_kernel_bytes;
  j["dropped"] = {{"non_finite", s.scene.non_finite}, {"zero_area", s.scene.zero_area}};
  j["skipped"] = {{"points", s.scene.skipped_points}, {"lines", s.scene.skipped_lines}};
  j["losses"] = nlohmann::ordered_json::array();
  for (const SceneLoss& l : s.scene.losses) j["losses"].push_back({{"name", l.name}, {"reason", l.reason}});
  fmt::print("{}\n", j.dump(2));
}

/// What is missing ends the log.
void print_losses(const SceneDescription& scene) {
  if (scene.losses.empty()) return;
  fmt::print(stderr, "the scene is incomplete, {} missing:\n", scene.losses.size());
  for (const SceneLoss& l : scene.losses) fmt::print(stderr, "  {}: {}\n", l.name, l.reason);
}

int run(const BakeOptions& options) {
  MpiSession mpi;
  int code = complete;
  try {
    const BakeRequest request = options.request();
    Progress progress;
    const BakeSummary summary = bake(mpi, request, progress.callbacks());
    if (mpi.rank() == 0) {
      options.json ? print_json(summary, request.out) : print_text(summary, request.out);
      std::fflush(stdout);
      print_losses(summary.scene);
      code = summary.scene.losses.empty() ? complete : cells_failed;
    }
  } catch (const OtherRankFailed&) {
    return failed;
  } catch (const InputError& e) {  // every rank fails alike: no need to abort the others
    fmt::print(stderr, "gigabake: {}\n", e.what());
    return failed;
  } catch (const UsageError& e) {
    if (mpi.rank() == 0) fmt::print(stderr, "gigabake: {}\n", e.what());
    return usage;
  }
  return mpi.from_master(code);
}

}  // namespace

void add_bake(CLI::App& app, int& exit_code) {
  auto* command =
      app.add_subcommand("bake", "Bake a scene into paged sparse voxel oct-trees; under mpirun on all ranks");
  auto options = std::make_shared<BakeOptions>();
  options->add_to(*command);
  command->add_option("-o,--out", options->out, "folder of the result: scene.xml and shards/")->required();
  command->add_flag("!--keep-going,--stop-on-failure", options->stop_on_failure,
                    "stop after a failed cell instead of baking the rest");
  command->callback([options, &exit_code] { exit_code = run(*options); });
}

}  // namespace gigabake::app
