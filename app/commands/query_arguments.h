/// The arguments of `gigabake query`, and what its questions share: memory, device, output and messages.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "app/options/area_options.h"
#include "query/query_text.h"
#include "query/scene_query.h"
#include "worker/device/backend.h"

namespace gigabake::app {

struct VolumeArguments {
  std::string area;  ///< file of polygons
  std::optional<double> above_m;
  std::string against;  ///< scene.xml of another scene
};

struct QueryArguments {
  std::string scene, out;
  std::string ray, rays, at, heights, grid, profile, sight, sights;
  VolumeArguments volume;
  double step = 0, max_distance_m = 0, ignore_ends_m = 0;
  QueryFrame frame = QueryFrame::scene;
  std::shared_ptr<const CrsMap> crs = nullptr;  ///< of QueryFrame::crs
  QueryFormat format = QueryFormat::csv;
  QueryOptions options;
  AreaOptions area;
  Backend backend = Backend::automatic;
  int threads = 0;
  bool quiet = false;

  bool shows_progress() const { return !quiet && !out.empty(); }
};

/// Returns the options of each of `scenes` scenes that are queried together. They share the memory, an eighth of which
/// is for rays in flight. Reduces `batch_rays` if the memory is small.
QueryOptions options_of(const QueryArguments& arguments, std::uint64_t scenes, std::size_t& batch_rays);

using TextSink = std::function<void(std::string_view)>;
/// Calls `make` with a function that writes to standard output or to the file of -o. The file appears only if `make`
/// returns.
/// Errors  InputError: the output cannot be written; and the exceptions of `make`.
void write_result(const QueryArguments& arguments, const std::function<void(const TextSink&)>& make);

/// Prints the missing cells that rays reached, and why the CPU cast rays in place of a device.
void print_problems(const QueryArguments& arguments, const SceneQuery& query);

/// Returns the scene.xml of --against, like scene_argument().
/// Errors  UsageError.
std::string other_scene_argument(const std::string& given);

/// Checks that the scene has a position on the earth, which the file of `option` needs.
/// Errors  UsageError.
void expect_on_earth(const char* option, const std::filesystem::path& scene_xml, const SceneQuery& query);

/// Answers --volume. Returns the exit code.
int run_volume(const QueryArguments& arguments, const ThreadPool& pool);

}  // namespace gigabake::app
