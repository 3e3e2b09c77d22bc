#include "cluster/watch/plan_file.h"

#include <string>
#include <system_error>
#include <vector>

#include "core/base/error.h"
#include "scheduler/journal/plan_record.h"
#include "scheduler/plan/merge.h"

namespace gigabake {

PlanFile::PlanFile(const BakeSession& session) : session_(session), path_(plan_file_of(session.request.out)) {
  std::vector<std::string> names;
  for (const TileRef& tile : session.sources.scene.tiles) names.push_back(tile.name);
  SceneHeader header = scene_header(session.plan, session.sources.scene.origin, session.request.parameters);
  try {
    write_plan_record(path_, plan_record_of(session.plan.jobs, std::move(header), std::move(names)));
  } catch (const InputError& e) {
    warn(e);
  }
}

PlanFile::~PlanFile() {
  std::error_code error;  // a file that stays is replaced by the next bake
  std::filesystem::remove(path_, error);
}

void PlanFile::take(const BakeEvent& event) const {
  const auto* failed = std::get_if<JobQuarantined>(&event);
  if (failed == nullptr || is_overview(failed->job)) return;
  try {
    append_failed_cell(path_, {failed->report.id, failed->report.error});
  } catch (const InputError& e) {
    warn(e);
  }
}

void PlanFile::warn(const std::exception& error) const {
  session_.report(WarningLine{std::string("viewers cannot follow this bake: ") + error.what()});
}

}  // namespace gigabake
