#include <cmath>
#include <fmt/format.h>
#include <memory>
#include <optional>

#include "app/commands.h"
#include "app/commands/query_arguments.h"
#include "app/messages/with_progress.h"
#include "app/options/scene_argument.h"
#include "app/process/clipped_scene.h"
#include "core/base/error.h"
#include "core/base/pluralize.h"
#include "core/base/usage_errors.h"
#include "format/area/geojson.h"
#include "format/system/message.h"
#include "query/volume/volume_text.h"

namespace gigabake::app {
namespace {

/// Returns the polygons of the file.
/// Errors  UsageError: the file cannot be used.
std::shared_ptr<const Area> polygons_of(const std::string& file) {
  Area area;
  area.polygons = with_usage_errors([&] { return read_geojson_polygons(file); });
  return std::make_shared<const Area>(std::move(area));
}

void expect_reference(const VolumeArguments& a) {
  if (a.above_m.has_value() == !a.against.empty())
    throw UsageError(
        "--volume: expected either --above HEIGHT, in metres above the ellipsoid, or --against OTHER, another scene");
  constexpr double max_height_m = 1e6;
  if (a.above_m && !(std::fabs(*a.above_m) <= max_height_m))
    throw UsageError("--above: expected metres above the WGS84 ellipsoid, within ±1e6");
}

/// A scene that is measured.
struct MeasuredScene {
  MeasuredScene(const QueryArguments& a, const std::filesystem::path& scene_xml, const QueryOptions& options,
                const ThreadPool& pool)
      : clipped(scene_xml, a.area, a.threads, a.shows_progress()),
        query(std::make_shared<const PagedScene>(clipped.file()), options, pool) {
    expect_on_earth("--volume", scene_xml, query);
  }

  ClippedScene clipped;
  SceneQuery query;
};

/// Opens the other scene.
/// Errors  UsageError: it cannot be read.
std::unique_ptr<MeasuredScene> open_other(const QueryArguments& a, const QueryOptions& options,
                                          const ThreadPool& pool) {
  if (a.volume.against.empty()) return nullptr;
  try {
    return std::make_unique<MeasuredScene>(a, a.volume.against, options, pool);
  } catch (const InputError& e) {
    throw UsageError(std::string("--against: ") + e.what());
  }
}

void warn_of_columns(const Volume& v) {
  const std::string of_all = fmt::format("of {} of the area", pluralize(v.columns.all(), "column"));
  if (v.columns.without_surface > 0)
    print_message("warning: {} {} have no surface; the volume lacks them\n", v.columns.without_surface, of_all);
  if (v.columns.outside > 0)
    print_message(
        "warning: {} {} are outside the bounds of the scene (gigabake info prints them); the volume lacks "
        "them\n",
        v.columns.outside, of_all);
}

int tell_volume(const QueryArguments& a, const Volume& v) {
  if (v.columns.missing > 0)
    print_message("gigabake: {} reached a cell that is missing, so the volume is unknown; bake the scene again\n",
                  pluralize(v.columns.missing, "column"));
  else if (!a.out.empty() && !a.quiet)
    fmt::print("{}: {}\n", a.out, volume_summary(v));
  if (!a.quiet) warn_of_columns(v);
  return v.columns.missing > 0 ? cells_failed : complete;
}

}  // namespace

std::string other_scene_argument(const std::string& given) {
  try {
    return scene_argument(given).string();
  } catch (const InputError& e) {
    throw UsageError(std::string("--against: ") + e.what());
  }
}

int run_volume(const QueryArguments& a, const ThreadPool& pool) {
  expect_reference(a.volume);
  expect_volume_format(a.format);
  VolumeJob job;
  job.area = polygons_of(a.volume.area);
  job.lod = a.options.lod;
  job.above_m = a.volume.above_m;
  const QueryOptions options = options_of(a, a.volume.against.empty() ? 1 : 2, job.batch_columns);
  MeasuredScene scene(a, a.scene, options, pool);
  const std::unique_ptr<MeasuredScene> other = open_other(a, options, pool);
  const Volume volume = with_progress(
      [&](const Progress& progress) {
        return measure_volume(job, scene.query, other ? &other->query : nullptr, pool, progress);
      },
      a.shows_progress() ? stderr : nullptr);
  write_result(a, [&](const TextSink& write) {
    write(volume_text(volume, {a.volume.above_m, a.volume.against}, a.format));
  });
  print_problems(a, scene.query);
  if (other) print_problems(a, other->query);
  return tell_volume(a, volume);
}

}  // namespace gigabake::app
