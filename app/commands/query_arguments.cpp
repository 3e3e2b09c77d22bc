#include "app/commands/query_arguments.h"

#include <algorithm>
#include <cstdio>

#include "app/options/flags.h"
#include "app/process/standard_streams.h"
#include "core/base/error.h"
#include "format/system/host_limits.h"
#include "format/system/message.h"
#include "format/system/output_file.h"
#include "format/system/publish.h"

namespace gigabake::app {
namespace {

/// Selects the device: immediately for `cuda`, otherwise at the first long batch, because a driver's start takes a
/// second.
void set_device(Backend backend, QueryOptions& options) {
  if (backend == Backend::cpu) return;
  options.device = [] { return choose_device({Backend::automatic}).device; };
  if (backend != Backend::cuda) return;
  options.device = [device = choose_device({backend}).device] { return device; };
  options.min_device_rays = 1;
}

}  // namespace

QueryOptions options_of(const QueryArguments& a, std::uint64_t scenes, std::size_t& batch_rays) {
  constexpr std::uint64_t bytes_per_ray = 1024, min_rays = 1024;
  QueryOptions options = a.options;
  const std::uint64_t all =
      (options.memory_bytes != 0 ? options.memory_bytes : host_limits().memory_bytes / 2) / scenes;
  batch_rays = std::size_t(std::clamp(all / 8 / bytes_per_ray, min_rays, std::uint64_t(batch_rays)));
  const std::uint64_t rays = batch_rays * bytes_per_ray;
  options.memory_bytes = all > rays ? all - rays : 0;
  options.device_bytes /= scenes;
  set_device(a.backend, options);
  return options;
}

void write_result(const QueryArguments& a, const std::function<void(const TextSink&)>& make) {
  if (a.out.empty()) {
    make([](std::string_view text) {
      if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size())
        throw InputError("standard output", "", "cannot be written");
    });
    return flush_output();
  }
  Publication publication(a.out, Leftovers::remove);
  OutputFile file(a.out, publication.temporary());
  make([&](std::string_view text) { file.write(text); });
  file.finish();
  publication.publish();
}

void print_problems(const QueryArguments& a, const SceneQuery& query) {
  for (const std::string& problem : query.problems())
    print_message("gigabake: cell missing: {}\n", with_flags(problem));
  if (!query.device_problem().empty() && (!a.quiet || a.backend == Backend::cuda))
    print_message("gigabake: the CPU cast {}: {}\n", query.counts().device_rays > 0 ? "some of the rays" : "the rays",
                  query.device_problem());
}

void expect_on_earth(const char* option, const std::filesystem::path& scene_xml, const SceneQuery& query) {
  if (!query.scene().header().origin)
    throw UsageError(std::string(option) + ": " + scene_xml.string() +
                     " has no position on the earth, but the file has; bake it with --origin LAT,LON,HEIGHT");
}

}  // namespace gigabake::app
