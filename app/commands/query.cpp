#include <algorithm>
#include <array>
#include <fmt/format.h>
#include <memory>
#include <numeric>
#include <optional>
#include <string>
#include <vector>

#include "app/commands.h"
#include "app/commands/query_arguments.h"
#include "app/messages/with_progress.h"
#include "app/options/choices.h"
#include "app/options/output_file.h"
#include "app/options/scene_argument.h"
#include "app/options/text_values.h"
#include "app/process/clipped_scene.h"
#include "core/base/error.h"
#include "core/base/memory_limit.h"
#include "core/base/pluralize.h"
#include "core/base/usage_errors.h"
#include "core/math/geodesic.h"
#include "format/area/geojson.h"
#include "format/source/raster/crs_map.h"
#include "format/system/host_limits.h"
#include "format/system/message.h"
#include "query/query_job.h"

namespace gigabake::app {
namespace {

std::unique_ptr<QuerySource> one_ray(const QueryArguments& a) {
  const char* const form =
      "X,Y,Z,DX,DY,DZ in scene metres, or X,Y,Z,AZIMUTH,ELEVATION; with --coordinates lonlat LON,LAT,HEIGHT in place "
      "of "
      "X,Y,Z";
  const auto v =
      a.frame == QueryFrame::scene ? numbers("--ray", form, a.ray, {5, 6}) : numbers("--ray", form, a.ray, {5});
  QueryInput ask{{}, {v[0], v[1], v[2]}, {v[3], v[4], v.size() == 6 ? v[5] : 0}};
  return single_query(ask, v.size() == 6 ? DirectionForm::direction : DirectionForm::angles, "--ray");
}

/// Returns the line of the file.
/// Errors  UsageError: the file cannot be used.
GeodesicPath line_of(const std::string& file) {
  return with_usage_errors([&] { return GeodesicPath(read_geojson_line(file)); });
}

struct Asked {
  QueryKind kind;
  std::unique_ptr<QuerySource> asks;
};

/// Returns the source of the queries on the command line, and whether they are rays, heights or lines of sight.
Asked question_of(const QueryArguments& a, const ThreadPool& pool) {
  if (!a.ray.empty()) return {QueryKind::ray, one_ray(a)};
  if (!a.rays.empty()) return {QueryKind::ray, table_queries(a.rays, QueryKind::ray, a.frame, pool)};
  if (!a.sights.empty()) return {QueryKind::sight, table_queries(a.sights, QueryKind::sight, a.frame, pool)};
  if (!a.heights.empty()) return {QueryKind::height, table_queries(a.heights, QueryKind::height, a.frame, pool)};
  if (!a.at.empty()) {
    const auto v = numbers("--at", "X,Y, or LON,LAT with --coordinates lonlat", a.at, {2});
    return {QueryKind::height, single_query({{}, {v[0], v[1], 0}, {}}, DirectionForm::point, "--at")};
  }
  if (!a.profile.empty())
    return {QueryKind::height, profile_queries(line_of(a.profile), a.step, "--profile " + a.profile)};
  if (!a.grid.empty()) {
    const auto v = numbers("--grid", "X,Y,X,Y: lower and upper corner", a.grid, {4});
    return {QueryKind::height, grid_queries({{v[0], v[1], v[2], v[3]}, a.step})};
  }
  const auto v = numbers("--sight", "X,Y,Z,X,Y,Z: two points", a.sight, {6});
  return {QueryKind::sight,
          single_query({{}, {v[0], v[1], v[2]}, {v[3], v[4], v[5]}}, DirectionForm::point, "--sight")};
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
  print_problems(a, query);
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

int run_rays(const QueryArguments& a, const ThreadPool& pool) {
  const Asked question = question_of(a, pool);
  QueryJob job;
  job.kind = question.kind;
  job.frame = a.frame;
  job.crs = a.crs;
  job.format = a.format;
  if (a.max_distance_m != 0) job.max_distance_m = a.max_distance_m;
  job.ignore_ends_m = a.ignore_ends_m;
  const QueryOptions options = options_of(a, 1, job.batch_rays);
  const ClippedScene scene(a.scene, a.area, a.threads, a.shows_progress());
  SceneQuery query(std::make_shared<const PagedScene>(scene.file()), options, pool);
  if (!a.profile.empty()) expect_on_earth("--profile", a.scene, query);
  QueryTally tally{};
  write_result(a, [&](const TextSink& write) {
    tally = with_progress(
        [&](const Progress& progress) { return run_query(job, query, *question.asks, pool, write, progress); },
        a.shows_progress() ? stderr : nullptr);
  });
  return tell(a, job.kind, tally, query);
}

void expect_one_question(const QueryArguments& a) {
  const std::array<const std::string*, 9> all{&a.ray,     &a.rays,  &a.at,     &a.heights,    &a.grid,
                                              &a.profile, &a.sight, &a.sights, &a.volume.area};
  if (std::count_if(all.begin(), all.end(), [](const std::string* s) { return !s->empty(); }) != 1)
    throw UsageError(
        "expected one of --ray, --rays, --at, --heights, --grid, --profile, --sight, --sights and --volume");
  if ((!a.grid.empty() || !a.profile.empty()) != (a.step != 0))
    throw UsageError("--step: expected the distance between points, above 0, with --grid or --profile, and only there");
  if (a.volume.area.empty() && (a.volume.above_m || !a.volume.against.empty()))
    throw UsageError("--above and --against: belong to --volume, which is missing");
}

int run(const QueryArguments& a) {
  expect_one_question(a);
  if (a.threads < 0 || a.threads > 1024) throw UsageError("--threads: expected 1 to 1024, or 0 for all cores");
  const ThreadPool pool(a.threads != 0 ? a.threads : host_limits().cores());
  return a.volume.area.empty() ? run_rays(a, pool) : run_volume(a, pool);
}

/// Selects the coordinates of questions and answers. --crs applies to them and to --bounds, unless --coordinates
/// selects others.
void choose_coordinates(QueryArguments& a, bool is_chosen) {
  std::string& crs = a.area.crs;
  if (!a.profile.empty()) {
    if (is_chosen && a.frame != QueryFrame::lonlat)
      throw UsageError("--profile: its answers are longitudes and latitudes; expected --coordinates lonlat or none");
    a.frame = QueryFrame::lonlat;
    return;
  }
  if (!a.volume.area.empty()) return;
  const bool is_scene = crs == "scene";
  if (!is_chosen && !crs.empty() && !is_scene) a.frame = QueryFrame::crs;
  if (a.frame == QueryFrame::crs) {
    if (crs.empty() || is_scene)
      throw UsageError("--coordinates: crs needs a coordinate system, such as --crs EPSG:25832+7837");
    try {
      a.crs = open_crs_map(crs);
    } catch (const InputError& e) {
      throw UsageError(std::string("--") + e.what());
    }
  }
  if (a.area.bounds.empty() && (a.crs || is_scene)) crs.clear();
}

/// Rejects an output file that would overwrite the queries or the scene.
void expect_apart(const QueryArguments& a) {
  std::vector<std::filesystem::path> inputs = files_of_bake(std::filesystem::path(a.scene).parent_path());
  for (const std::string* file : {&a.rays, &a.heights, &a.sights, &a.profile, &a.volume.area})
    inputs.emplace_back(*file);
  if (!a.volume.against.empty())
    for (const auto& file : files_of_bake(std::filesystem::path(a.volume.against).parent_path()))
      inputs.push_back(file);
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
  command.add_option("--profile", a.profile,
                     "LINE.geojson: heights along its LineString, --step metres apart, in longitude and latitude");
  command.add_option("--step", a.step, "distance between points of --grid (metres or degrees) or --profile (metres)");
  command.add_option("--sight", a.sight, "X,Y,Z,X,Y,Z: whether two points see each other");
  command.add_option("--sights", a.sights, "CSV or .npy file of pairs of points");
  command.add_option("--volume", a.volume.area,
                     "AREA.geojson: cut and fill inside its polygons, from --above or --against");
  command.add_option("--above", a.volume.above_m,
                     "HEIGHT: compare the surface with this height, metres above the WGS84 ellipsoid: above it is cut, "
                     "below it is fill");
  command.add_option(
      "--against", a.volume.against,
      "OTHER: compare the surface with another scene: where OTHER is lower is cut, where it is higher is "
      "fill");
  add_choice(command, "--coordinates", a.frame,
             "coordinates of input and answers: scene metres; longitude, latitude and height; or the system of --crs, "
             "which is the default with --crs");
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
  command.callback([a, &command, &exit_code] {
    a->scene = scene_argument(a->scene).string();
    choose_coordinates(*a, command.count("--coordinates") > 0);
    if (!a->volume.against.empty()) a->volume.against = other_scene_argument(a->volume.against);
    expect_apart(*a);
    exit_code = run(*a);
  });
}

}  // namespace gigabake::app
