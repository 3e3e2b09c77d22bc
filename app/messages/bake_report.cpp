#include "app/messages/bake_report.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <numbers>
#include <utility>

#include "app/messages/json_text.h"
#include "app/messages/run_report.h"
#include "app/messages/similar_lines.h"
#include "app/messages/status_text.h"
#include "app/options/flags.h"
#include "app/process/standard_streams.h"
#include "core/base/host_device.h"
#include "core/base/pluralize.h"
#include "core/base/quote.h"
#include "format/system/message.h"
#include "scheduler/plan/estimate.h"

namespace gigabake::app {
namespace {

constexpr std::size_t slow_cells_printed = 3;

/// Totals over the scene's cells and overviews.
struct Totals {
  std::uint64_t voxels = 0, finest_voxels = 0, bytes = 0;
  explicit Totals(const SceneDescription& scene) {
    for (const auto& shards : {&scene.cells, &scene.overviews})
      for (const SceneCell& c : *shards) {
        voxels += c.own_voxels();
        if (c.first_lod == 0 && !c.voxels.empty()) finest_voxels += c.voxels[0];
        bytes += c.bytes;
      }
  }
};

const char* slowest_stage(const BakeSummary& s) {
  if (s.read_s >= s.kernel_s && s.read_s >= s.write_s) return "read";
  return s.kernel_s >= s.write_s ? "kernels" : "write";
}

void print_slowest(const std::vector<SlowCell>& cells) {
  if (cells.empty()) return;
  fmt::print("slowest cells");
  for (std::size_t i = 0; i < cells.size() && i < slow_cells_printed; ++i)
    fmt::print("{} {} {:.2f} s", i == 0 ? "" : ",", cells[i].name, cells[i].seconds);
  fmt::print("\n");
}

void add_slowest(const std::vector<SlowCell>& cells, nlohmann::ordered_json& j) {
  j["slowest_cells"] = nlohmann::ordered_json::array();
  for (const SlowCell& c : cells) {
    j["slowest_cells"].push_back({{"name", c.name}, {"seconds", c.seconds}});
    if (c.rank) j["slowest_cells"].back()["rank"] = *c.rank;
  }
}

std::string text_of(const nlohmann::ordered_json& j) { return json_text(j) + "\n"; }

/// Prints parts of the source that are missing in the plan or scene, with the reason.
template <class Counts>
void print_left_out(const Counts& c) {
  if (c.non_finite + c.zero_area != 0)
    fmt::print("dropped: {} with NaN or infinite vertices, {} without area\n", pluralize(c.non_finite, "triangle"),
               c.zero_area);
  if (c.skipped_points + c.skipped_lines != 0)
    fmt::print("skipped: {} and {}, which have no surface\n", pluralize(c.skipped_points, "point"),
               pluralize(c.skipped_lines, "line"));
}

void add_precision(const SourcePrecision& p, nlohmann::ordered_json& j) {
  nlohmann::ordered_json& out = j["source_precision"];
  out = {{"wanted_m", p.wanted_m},
         {"largest_spacing_m", p.max_spacing_m},
         {"coarse_sources", p.coarse_sources},
         {"coarse", nlohmann::ordered_json::array()}};
  for (const CoarseSource& c : p.coarse) out["coarse"].push_back({{"name", c.name}, {"spacing_m", c.spacing_m}});
}

/// Adds the error bounds that are known without reading the scene again; docs/accuracy.md defines each number.
void add_accuracy(const BakeSummary& s, nlohmann::ordered_json& j) {
  const double half_step_m = s.scene.voxel_size_m / double(2 * subvoxels);
  j["snap_error_bound_m"] = {{"axis", half_step_m}, {"distance", std::numbers::sqrt3 * half_step_m}};
  add_precision(s.precision, j);
  j["levels"] = nlohmann::ordered_json::array();
  for (std::size_t lod = 0; lod < s.levels.size(); ++lod) {
    const LevelSummary& level = s.levels[lod];
    const std::uint64_t voxels = level.voxels();
    j["levels"].push_back({{"lod", lod},
                           {"voxel_size_m", std::ldexp(s.scene.voxel_size_m, int(lod))},
                           {"voxels", voxels},
                           {"bytes", level.stored_bytes},
                           {"bytes_per_voxel", voxels == 0 ? 0 : double(level.stored_bytes) / double(voxels)},
                           {"mean_coverage", level.mean_coverage()},
                           {"coverage", level.coverage}});
  }
}

template <class Counts>
void add_left_out(const Counts& c, nlohmann::ordered_json& j) {
  j["dropped"] = {{"non_finite", c.non_finite}, {"zero_area", c.zero_area}};
  j["skipped"] = {{"points", c.skipped_points}, {"lines", c.skipped_lines}};
  j["losses"] = nlohmann::ordered_json::array();
  for (const SceneLoss& l : c.losses) j["losses"].push_back({{"name", l.name}, {"reason", l.reason}});
}

/// Prints "12 of 400 cells to bake: 3 new, 9 changed inputs; 0 to check, 388 unchanged".
void print_counts(const CachedResults& prior) {
  const auto counts = prior.counts();
  const auto of = [&](CacheStatus r) { return counts[std::size_t(r)]; };
  std::size_t to_bake = 0;
  std::string why;
  for (const auto& [reason, words] :
       {std::pair(CacheStatus::new_cell, "new"), std::pair(CacheStatus::inputs_changed, "changed inputs"),
        std::pair(CacheStatus::shard_missing, "without a shard")}) {
    to_bake += of(reason);
    if (of(reason) != 0) why += fmt::format("{} {} {}", why.empty() ? ":" : ",", of(reason), words);
  }
  fmt::print("{} of {} to bake{}; {} to check, {} unchanged\n", to_bake, pluralize(prior.reasons.size(), "cell"), why,
             of(CacheStatus::to_be_checked), of(CacheStatus::unchanged));
}

}  // namespace

void print_report(const BakeSummary& s, const std::filesystem::path& out) {
  const Totals t(s.scene);
  fmt::print("{} ({} empty), {}, {} at lod 0, {} in all, {} on disk\n", pluralize(s.scene.cells.size(), "cell"),
             s.cells_empty, pluralize(s.scene.triangles, "triangle"), pluralize(t.finest_voxels, "voxel"), t.voxels,
             readable_bytes(t.bytes));
  print_left_out(s.scene);
  if (s.status.process_restarts != 0)
    fmt::print("bake processes that were started again: {}\n", s.status.process_restarts);
  if (s.bad_uv != 0)
    fmt::print("{} texture coordinates that are no numbers; baked as if 0\n",
               pluralize(s.bad_uv, "triangle has", "triangles have"));
  fmt::print("scan {:.2f} s, bake {:.2f} s on {} × {}; ", s.scan_s, s.bake_s, pluralize(s.ranks, "rank"),
             pluralize(s.threads, "thread"));
  if (s.ranks_with_device != 0)
    fmt::print("{} on the GPUs of {}; ", pluralize(s.cells_on_device, "cell"), pluralize(s.ranks_with_device, "rank"));
  fmt::print("stages read {:.2f} s, kernels {:.2f} s, write {:.2f} s: {} takes longest\n", s.read_s, s.kernel_s,
             s.write_s, slowest_stage(s));
  if (s.ranks_with_device != 0 && s.scene.has_classes) fmt::print("cells with classes are baked on the CPU\n");
  print_slowest(s.status.slowest);
  fmt::print("peak memory {} (kernels {})\n", readable_bytes(s.peak_process_bytes),
             readable_bytes(s.peak_kernel_bytes));
  if (s.pruned.files != 0)
    fmt::print("{} of earlier bakes removed, {}\n", pluralize(s.pruned.files, "shard"), readable_bytes(s.pruned.bytes));
  if (s.orphans.files != 0)
    fmt::print("{} of earlier bakes kept, {}; --prune removes {}\n", pluralize(s.orphans.files, "shard"),
               readable_bytes(s.orphans.bytes), s.orphans.files == 1 ? "it" : "them");
  if (s.amounts.voxels != 0) fmt::print("{}\n", run_text(s));
  if (!s.scene.cells.empty()) fmt::print("{}\n", (out / "scene.xml").string());
}

std::string json_report(const BakeSummary& s, const std::filesystem::path& out) {
  const Totals t(s.scene);
  nlohmann::ordered_json j;
  j["scene"] = (out / "scene.xml").string();
  j["cells"] = s.scene.cells.size();
  j["cells_planned"] = s.cells_planned;
  j["cells_empty"] = s.cells_empty;
  j["cells_taken_over"] = s.cells_taken_over;
  j["triangles"] = s.scene.triangles;
  j["voxels_lod0"] = t.finest_voxels;
  j["voxels"] = t.voxels;
  j["bytes"] = t.bytes;
  j["ranks"] = s.ranks;
  j["threads"] = s.threads;
  j["ranks_with_device"] = s.ranks_with_device;
  j["cells_on_device"] = s.cells_on_device;
  j["process_deaths"] = s.status.process_restarts;
  j["lost_ranks"] = s.lost_ranks;
  j["drained"] = s.is_drained;
  if (!s.no_device.empty()) j["no_device"] = s.no_device;
  j["seconds"] = {
      {"survey", s.scan_s}, {"bake", s.bake_s}, {"read", s.read_s}, {"kernels", s.kernel_s}, {"write", s.write_s}};
  j["slowest_stage"] = slowest_stage(s);
  add_slowest(s.status.slowest, j);
  add_run(s, j);
  j["peak_process_bytes"] = s.peak_process_bytes;
  j["peak_kernel_bytes"] = s.peak_kernel_bytes;
  j["bad_uv"] = s.bad_uv;
  j["orphans"] = {{"shards", s.orphans.files}, {"bytes", s.orphans.bytes}};
  j["pruned"] = {{"shards", s.pruned.files}, {"bytes", s.pruned.bytes}};
  add_accuracy(s, j);
  add_left_out(s.scene, j);
  j["warnings"] = s.warnings;
  return text_of(j);
}

namespace {

void print_cells(const BakePlan& plan, const std::optional<CachedResults>& prior) {
  for (const CellJob& job : plan.jobs)
    fmt::print("  {:<24} lattice {} {} {}  {}  {}{}\n", job.name, job.lattice_min[0], job.lattice_min[1],
               job.lattice_min[2], pluralize(job.tiles.size(), "tile"), pluralize(job.triangles, "triangle"),
               prior ? fmt::format("  {}", name_of(prior->reasons[job.id])) : "");
}

/// The cells that an earlier bake has not finished.
struct RemainingWork {
  std::size_t cells = 0;
  double fraction = 0;  ///< fraction of the work of all cells
  std::optional<double> bake_s;

  RemainingWork(const BakePlan& plan, const CachedResults& prior, const PlanSizes& sizes) {
    double all = 0, remaining = 0;
    for (const CellJob& job : plan.jobs) {
      all += double(cell_cost(job));
      const CacheStatus reason = prior.reasons[job.id];
      if (reason == CacheStatus::unchanged || reason == CacheStatus::to_be_checked) continue;
      remaining += double(cell_cost(job));
      ++cells;
    }
    if (all > 0) fraction = remaining / all;
    const auto& asked = sizes.measure.sizes;
    if (asked.size() > 1 && asked[1].estimate.bake_s) bake_s = *asked[1].estimate.bake_s * fraction;
  }
};

void print_remaining(const RemainingWork& r) {
  fmt::print("remaining: {}, {:.3g} % of the work{}\n", pluralize(r.cells, "cell"), 100 * r.fraction,
             r.bake_s ? ", about " + readable_seconds(*r.bake_s) : "");
}

}  // namespace

void print_report(const BakePlan& plan, const std::optional<CachedResults>& prior, const PlanSizes& sizes,
                  bool lists_cells) {
  const PlanEstimate e = estimate(plan);
  fmt::print("{}, {}, {} of them in the largest cell\n", pluralize(plan.jobs.size(), "cell"),
             pluralize(plan.triangles, "triangle"), e.max_cell_triangles);
  print_left_out(plan);
  if (lists_cells) print_cells(plan, prior);
  if (prior) {
    print_counts(*prior);
    print_remaining(RemainingWork(plan, *prior, sizes));
  }
  fmt::print("about {} of kernel memory for the largest cell\n", readable_bytes(e.kernel_bytes));
  fmt::print("{}", sizes_text(sizes));
}

namespace {

/// Prints one line per cell without building a JSON document, which would take gigabytes for millions of cells. Names
/// of cells are plain ASCII.
void print_jobs(const BakePlan& plan, const std::optional<CachedResults>& prior) {
  for (const CellJob& job : plan.jobs) {
    fmt::print(
        "{}\n    {{\"name\": \"{}\", \"lattice_min\": [{}], \"tiles\": {}, \"triangles\": {}, \"fingerprint\": \"{}\"",
        job.id == 0 ? "" : ",", job.name, fmt::join(job.lattice_min, ", "), job.tiles.size(), job.triangles,
        job.fingerprint.hex());
    if (prior) fmt::print(", \"prior\": \"{}\"", name_of(prior->reasons[job.id]));
    fmt::print("}}");
  }
}

}  // namespace

void print_json_report(const BakePlan& plan, const std::optional<CachedResults>& prior, const PlanSizes& sizes) {
  const PlanEstimate e = estimate(plan);
  nlohmann::ordered_json j;
  j["cells"] = plan.jobs.size();
  j["triangles"] = plan.triangles;
  j["estimate"] = {{"largest_cell_triangles", e.max_cell_triangles}, {"kernel_bytes", e.kernel_bytes}};
  add_sizes(sizes, j);
  if (prior) {
    const auto counts = prior->counts();
    for (std::size_t r = 0; r < counts.size(); ++r) j["prior"][std::string(name_of(CacheStatus(r)))] = counts[r];
    const RemainingWork remaining(plan, *prior, sizes);
    j["remaining"] = {{"cells", remaining.cells}, {"fraction", remaining.fraction}, {"bake_s", nullptr}};
    if (remaining.bake_s) j["remaining"]["bake_s"] = *remaining.bake_s;
  }
  nlohmann::ordered_json rest;
  add_precision(plan.precision, rest);
  add_left_out(plan, rest);
  rest["warnings"] = plan.warnings;
  const std::string head = text_of(j), tail = text_of(rest);
  fmt::print("{},\n  \"jobs\": [", std::string_view(head).substr(0, head.rfind("\n}")));
  print_jobs(plan, prior);
  fmt::print("],{}", std::string_view(tail).substr(1));
}

void warn_of(const SourcePrecision& precision) {
  put_output_before_messages();
  if (precision.coarse.empty()) return;
  const CoarseSource& worst = precision.coarse[0];
  const std::uint64_t more = precision.coarse_sources - 1;
  print_message(
      "warning: {} stores positions in steps of up to {:.3g} m, but voxels are {:.6g} m{}; its vertices are off by "
      "up to half a step. Write them relative to a centre (a tile's transform, RTC_CENTER) or with more bits\n",
      short_path(worst.name), worst.spacing_m, precision.wanted_m * 4,
      more == 0 ? "" : "; and " + pluralize(more, "more source"));
}

void print_losses(const std::vector<SceneLoss>& losses) {
  put_output_before_messages();
  if (losses.empty()) return;
  print_message("incomplete, {} missing:\n", losses.size());
  for (const std::string& line : lines_of(losses)) print_message("  {}\n", with_flags(line));
}

}  // namespace gigabake::app
