#include <algorithm>
#include <array>
#include <cstdio>
#include <fmt/format.h>
#include <memory>
#include <numeric>
#include <optional>
#include <string>
#include <vector>

#include "app/commands.h"
#include "app/messages/with_progress.h"
#include "app/options/choices.h"
#include "app/options/flags.h"
#include "app/options/output_file.h"
#include "app/options/scene_argument.h"
#include "app/options/text_values.h"
#include "app/process/clipped_scene.h"
#include "app/process/standard_streams.h"
#include "core/base/error.h"
#include "core/base/memory_limit.h"
#include "core/base/pluralize.h"
#include "format/system/host_limits.h"
#include "format/system/message.h"
#include "format/system/output_file.h"
#include "format/system/publish.h"
#include "query/query_job.h"
#include "worker/pipeline/backend.h"

namespace gigabake::app {
namespace {

struct QueryArguments {
  std::string scene, out;
  std::string ray, rays, at, heights, grid, sight, sights;
  double step = 0, max_distance_m = 0, ignore_ends_m = 0;
  QueryFrame frame = QueryFrame::scene;
  QueryFormat format = QueryFormat::csv;
  QueryOptions options;
  AreaOptions area;
  Backend backend = Backend::automatic;
  int threads = 0;
  bool quiet = false;
};

std::unique_ptr<QuerySource> one_ray(const QueryArguments& a) {
  const char* const form =
      "X,Y,Z,DX,DY,DZ or X,Y,Z,AZIMUTH,ELEVATION, only the latter with --coordinates lonlat, in place of X,Y,Z then";
  const auto v =
      a.frame == QueryFrame::lonlat ? numbers("--ray", form, a.ray, {5}) : numbers("--ray", form, a.ray, {5, 6});
  QueryInput ask{{}, {v[0], v[1], v[2]}, {v[3], v[4], v.size() == 6 ? v[5] : 0}};
  return single_query(ask, v.size() == 6 ? DirectionForm::direction : DirectionForm::angles, "--ray");
}

struct Asked {
  QueryKind kind;
  std::unique_ptr<QuerySource> asks;
};

/// Returns the source of the queries on the command line, and whether they are rays, heights or lines of sight.
Asked question_of(const QueryArguments& a, const ThreadPool& pool) {
  const std::array<const std::string*, 7> all{&a.ray, &a.rays, &a.at, &a.heights, &a.grid, &a.sight, &a.sights};
  if (std::count_if(all.begin(), all.end(), [](const std::string* s) { return !s->empty(); }) != 1)
    throw UsageError("expected one of --ray, --rays, --at, --heights, --grid, --sight and --sights");
  if (!a.grid.empty() != (a.step != 0)) throw UsageError("--grid and --step: expected both or none of them");
  if (!a.ray.empty()) return {QueryKind::ray, one_ray(a)};
  if (!a.rays.empty()) return {QueryKind::ray, table_queries(a.rays, QueryKind::ray, a.frame, pool)};
  if (!a.sights.empty()) return {QueryKind::sight, table_queries(a.sights, QueryKind::sight, a.frame, pool)};
  if (!a.heights.empty()) return {QueryKind::height, table_queries(a.heights, QueryKind::height, a.frame, pool)};
  if (!a.at.empty()) {
    const auto v = numbers("--at", "X,Y, or LON,LAT with --coordinates lonlat", a.at, {2});
    return {QueryKind::height, single_query({{}, {v[0], v[1], 0}, {}}, DirectionForm::point, "--at")};
  }
  if (!a.grid.empty()) {
    const auto v = numbers("--grid", "X,Y,X,Y: lower and upper corner", a.grid, {4});
    return {QueryKind::height, grid_queries({{v[0], v[1], v[2], v[3]}, a.step})};
  }
  const auto v = numbers("--sight", "X,Y,Z,X,Y,Z: two points", a.sight, {6});
  return {QueryKind::sight,
          single_query({{}, {v[0], v[1], v[2]}, {v[3], v[4], v[5]}}, DirectionForm::point, "--sight")};
}

/// Selects the device: immediately for `cuda`, otherwise at the first long batch, because a driver's start takes a
/// second.
void set_device(Backend backend, QueryOptions& options) {
  if (backend == Backend::cpu) return;
  options.device = [] { return choose_device({Backend::automatic}).device; };
  if (backend != Backend::cuda) return;
  options.device = [device = choose_device({backend}).device] { return device; };
  options.min_device_rays = 1;
}

/// Assigns an eighth of the memory to queries and results in flight, and the rest to trees.
void share_memory(std::uint64_t memory_bytes, QueryOptions& options, QueryJob& job) {
  constexpr std::uint64_t bytes_per_ray = 1024, min_rays = 1024;
  const std::uint64_t all = memory_bytes != 0 ? memory_bytes : host_limits().memory_bytes / 2;
  job.batch_rays = std::size_t(std::clamp(all / 8 / bytes_per_ray, min_rays, std::uint64_t(job.batch_rays)));
  const std::uint64_t rays = job.batch_rays * bytes_per_ray;
  options.memory_bytes = all > rays ? all - rays : 0;
}

QueryTally write_answers(const QueryArguments& a, const QueryJob& job, SceneQuery& query, QuerySource& asks,
                         const ThreadPool& pool, const Progress& progress) {
  if (a.out.empty())
    return run_query(
        job, query, asks, pool,
        [](std::string_view text) {
          if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size())
            throw InputError("standard output", "", "cannot be written");
        },
        progress);
  Publication publication(a.out, Leftovers::remove);
  OutputFile file(a.out, publication.temporary());
  const QueryTally tally = run_query(
      job, query, asks, pool, [&](std::string_view text) { file.write(text); }, progress);
  file.finish();
  publication.publish();
  return tally;
}

/// Returns "1 place is", "2 rays are".
std::string questions(QueryKind kind, std::uint64_t count) {
  switch (kind) {
    case QueryKind::ray:
      return pluralize(count, "ray is", "rays are");
    case QueryKind::height:
      return pluralize(count, "place is", "places are");
    case QueryKind::sight:
      break;
  }
  return pluralize(count, "line of sight is", "lines of sight are");
}

void warn_of_outside(QueryKind kind, const QueryTally& tally) {
  const std::uint64_t outside = tally[std::size_t(QueryOutcome::outside)];
  const std::uint64_t all = std::accumulate(tally.begin(), tally.end(), std::uint64_t(0));
  if (outside > 0)
    print_message("warning: {} of {} outside the bounds of the scene (gigabake info prints them)\n", outside,
                  questions(kind, all));
}

int tell(const QueryArguments& a, QueryKind kind, const QueryTally& tally, SceneQuery& query) {
  const auto of = [&](QueryOutcome outcome) { return tally[std::size_t(outcome)]; };
  for (const std::string& problem : query.problems())
    print_message("gigabake: cell missing: {}\n", with_flags(problem));
  if (!query.device_problem().empty() && (!a.quiet || a.backend == Backend::cuda))
    print_message("gigabake: the CPU cast {}: {}\n", query.counts().device_rays > 0 ? "some of the rays" : "the rays",
                  query.device_problem());
  if (!a.out.empty() && !a.quiet)
    fmt::print("{}: {} hit, {} hit nothing, {} outside the scene, {} where a cell is missing; {} built, {} at most\n",
               a.out, of(QueryOutcome::hit), of(QueryOutcome::nothing), of(QueryOutcome::outside),
               of(QueryOutcome::missing), pluralize(query.counts().trees_built, "tree"),
               readable_size(query.counts().peak_bytes));
  if (of(QueryOutcome::missing) > 0)
    print_message("gigabake: {} reached a cell that is missing; bake the scene again\n",
                  pluralize(of(QueryOutcome::missing), "ray"));
  if (!a.quiet) warn_of_outside(kind, tally);
  return of(QueryOutcome::missing) > 0 ? cells_failed : complete;
}

int run(const QueryArguments& a) {
  if (a.threads < 0 || a.threads > 1024) throw UsageError("--threads: expected 1 to 1024, or 0 for all cores");
  const ThreadPool pool(a.threads != 0 ? a.threads : host_limits().cores());
  const Asked question = question_of(a, pool);
  QueryJob job;
  job.kind = question.kind;
  job.frame = a.frame;
  job.format = a.format;
  if (a.max_distance_m != 0) job.max_distance_m = a.max_distance_m;
  job.ignore_ends_m = a.ignore_ends_m;
  QueryOptions options = a.options;
  share_memory(a.options.memory_bytes, options, job);
  set_device(a.backend, options);
  const ClippedScene scene(a.scene, a.area, a.threads, !a.quiet && !a.out.empty());
  SceneQuery query(std::make_shared<const PagedScene>(scene.file()), options, pool);
  const QueryTally tally = with_progress(
      [&](const Progress& progress) { return write_answers(a, job, query, *question.asks, pool, progress); },
      a.quiet || a.out.empty() ? nullptr : stderr);
  flush_output();
  return tell(a, job.kind, tally, query);
}

/// Rejects an output file that would overwrite the queries or the scene.
void expect_apart(const QueryArguments& a) {
  std::vector<std::filesystem::path> inputs = files_of_bake(std::filesystem::path(a.scene).parent_path());
  for (const std::string* table : {&a.rays, &a.heights, &a.sights}) inputs.emplace_back(*table);
  expect_no_input("-o", a.out, inputs);
  expect_parent_folder("-o", a.out);
}

void add_questions(CLI::App& command, QueryArguments& a) {
  command.add_option("--ray", a.ray, "X,Y,Z,DX,DY,DZ: one ray; or X,Y,Z,AZIMUTH,ELEVATION in degrees");
  command.add_option("--rays", a.rays, "CSV or .npy file of rays; - is standard input (columns: docs/query.md)");
  command.add_option("--at", a.at, "X,Y: height of the highest surface there, to within half a voxel");
  command.add_option("--heights", a.heights, "CSV or .npy file of places");
  command.add_option(
      "--grid", a.grid,
      "X,Y,X,Y: heights at points from a lower to an upper corner, --step apart, to within half a voxel");
  command.add_option("--step", a.step, "distance between points of --grid, metres or degrees");
  command.add_option("--sight", a.sight, "X,Y,Z,X,Y,Z: whether two points see each other");
  command.add_option("--sights", a.sights, "CSV or .npy file of pairs of points");
  add_choice(command, "--coordinates", a.frame,
             "coordinates of input and answers: scene metres, or longitude, latitude and height");
}

}  // namespace

void add_query(CLI::App& app, int& exit_code) {
  CLI::App& command = *app.add_subcommand("query", "Print what rays hit first: rays, heights, lines of sight");
  const auto a = std::make_shared<QueryArguments>();
  command.add_option("SCENE", a->scene, "folder of a bake, or its scene.xml")->required();
  add_questions(command, *a);
  add_choice(command, "--format", a->format, "format of the answers; npy: a NumPy array, for long lists");
  command.add_option("-o,--output", a->out, "file to write (standard output)");
  command.add_option("--lod", a->options.lod, "finest level that rays hit")->capture_default_str();
  command
      .add_option("--footprint", a->options.spread,
                  "growth of a ray's width, metres per metre: it hits the coarsest voxels that are not wider than the "
                  "ray; 0: the voxels of --lod")
      ->capture_default_str();
  command.add_option("--max-distance", a->max_distance_m, "max length of rays and lines of sight, metres (unlimited)");
  command
      .add_option("--ignore-ends", a->ignore_ends_m,
                  "metres: surfaces within this distance of an end of a line of sight do not block it")
      ->capture_default_str();
  a->area.add_to(command);
  add_choice(command, "--backend", a->backend, "backend that casts long lists of rays; auto: a GPU if there is one");
  command.add_option("--threads", a->threads, "CPU threads (all cores)");
  command.add_option("--gpu-memory", a->options.device_bytes, "max bytes of voxels in GPU memory (4G)")
      ->transform(CLI::AsSizeValue(false));
  command
      .add_option("--memory", a->options.memory_bytes,
                  "max bytes of voxels in memory, such as 512M or 4G; 0: half of the host's memory (1G)")
      ->transform(CLI::AsSizeValue(false));
  command.add_flag("-q,--quiet", a->quiet, "print only errors");
  command.callback([a, &exit_code] {
    a->scene = scene_argument(a->scene).string();
    expect_apart(*a);
    exit_code = run(*a);
  });
}

}  // namespace gigabake::app
