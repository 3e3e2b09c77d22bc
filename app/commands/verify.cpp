#include "format/scene/check/verify.h"

#include <fmt/format.h>
#include <limits>
#include <malloc.h>
#include <memory>
#include <nlohmann/json.hpp>

#include "app/commands.h"
#include "app/messages/json_text.h"
#include "app/messages/missing_json.h"
#include "app/messages/status_text.h"
#include "app/messages/with_progress.h"
#include "app/options/scene_argument.h"
#include "core/base/pluralize.h"
#include "format/system/host_limits.h"
#include "worker/overview/overview_check.h"

namespace gigabake::app {
namespace {

/// Returns the state of a scene without faults.
std::string state_of(const VerifyResult& r) {
  return r.missing.any() ? "sound, but incomplete: " + describe(r.missing) : std::string("whole");
}

/// Makes glibc keep freed memory. Each cell needs about the same memory as the cell before, and the page faults of new
/// memory took a fifth of the time.
void keep_freed_memory() {
  constexpr int max_kept_block = 32 << 20;  // glibc's limit
  ::mallopt(M_MMAP_THRESHOLD, max_kept_block);
  ::mallopt(M_TRIM_THRESHOLD, std::numeric_limits<int>::max());
  ::mallopt(M_TOP_PAD, 2 * max_kept_block);
}

}  // namespace

void add_verify(CLI::App& app, int& exit_code) {
  auto* command = app.add_subcommand("verify",
                                     "Check every checksum, reference and invariant of a baked scene; exit code 1 on a "
                                     "fault, 3 if it is sound but incomplete");
  auto scene = std::make_shared<std::string>();
  auto json = std::make_shared<bool>(false), quiet = std::make_shared<bool>(false);
  command->add_option("SCENE", *scene, "folder of a bake, or its scene.xml")->required();
  command->add_flag("--json", *json, "print the answer as JSON");
  command->add_flag("-q,--quiet", *quiet, "print only faults");
  command->callback([scene, json, quiet, &exit_code] {
    keep_freed_memory();
    const std::filesystem::path file = scene_argument(*scene);
    const auto check_overview = [&file](const SceneHeader& header, const SceneCell& overview,
                                        std::span<const SceneCell> children) {
      return overview_faults(file.parent_path(), header, overview, children);
    };
    const auto verify = [&](const Progress& progress) {
      return verify_scene(file, host_limits().cores(), progress, check_overview);
    };
    const VerifyResult r = while_reading(verify, *quiet ? nullptr : stderr);
    exit_code = r.faults.empty() ? complete : failed;
    if (*json) {
      nlohmann::ordered_json j{{"cells", r.cells},
                               {"voxels", r.voxels},
                               {"bytes", r.bytes},
                               {"has_totals", r.has_totals},
                               {"missing", json_of_missing(r.missing)},
                               {"faults", r.faults}};
      fmt::print("{}\n", json_text(j));
      return;
    }
    for (const std::string& fault : r.faults) fmt::print("{}\n", fault);
    if (*quiet) return;
    if (!r.has_totals)
      fmt::print(
          "{}: has no summary because it is a scene of version 1, so missing cells cannot be detected; bake it again "
          "to add the summary\n",
          file.string());
    fmt::print("{}, {}, {}: {}\n", pluralize(r.cells, "cell"), pluralize(r.voxels, "voxel"), readable_bytes(r.bytes),
               r.faults.empty() ? state_of(r) : pluralize(r.faults.size(), "fault"));
  });
}

}  // namespace gigabake::app
