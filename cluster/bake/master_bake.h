/// Rank 0's work from the plan to the scene: finds cached results, dispatches the rest, merges the reports, publishes
/// the scene.
#pragma once

#include <optional>
#include <vector>

#include "cluster/bake/bake_session.h"
#include "cluster/bake/output_folder.h"
#include "cluster/bake/status_feed.h"
#include "cluster/mpi/mpi_session.h"
#include "cluster/process/bake_process.h"
#include "cluster/watch/plan_file.h"
#include "scheduler/journal/journal.h"

namespace gigabake {

/// Throws if `losses` prevent publication of the scene. `nothing_baked` means that no cell was or can be baked.
/// Errors  InputError with the first loss.
void refuse(const BakeRequest& request, const std::vector<SceneLoss>& losses, bool nothing_baked);

class MasterBake {
 public:
  /// Borrows the session of rank 0, which must contain a plan and outlive this object.
  explicit MasterBake(BakeSession& session);

  /// Bakes the cells that OUT does not contain from earlier bakes, publishes the scene and completes the summary.
  /// Errors  InputError; OUT/scene.xml is then unchanged.
  void run();

 private:
  void report_reused(const std::vector<CellReport>& done) const;
  void take(const BakeEvent& event);
  std::size_t cells_among(const std::vector<CellReport>& reports) const;
  void forget_orphans();
  void publish();
  void publish_scene();

  BakeSession& session_;
  const BakeRequest& request_;
  const BakePlan& plan_;
  const OutputFolder& out_;
  BakeSummary& summary_;
  std::optional<Journal> journal_;
  std::optional<PlanFile> plan_file_;
};

}  // namespace gigabake
