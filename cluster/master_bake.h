/// What rank 0 does from the plan to the scene: looks for what is there, has the rest baked, merges the reports,
/// publishes the scene.
#pragma once

#include <optional>
#include <vector>

#include "cluster/bake.h"
#include "cluster/bake_process.h"
#include "cluster/mpi_session.h"
#include "cluster/output_folder.h"
#include "cluster/status_feed.h"
#include "scheduler/journal.h"

namespace gigabake {

/// Throws where these losses leave the previous scene in place. Errors  InputError.
void refuse(const BakeRequest& request, const std::vector<SceneLoss>& losses, bool nothing_baked);

class MasterBake {
 public:
  /// All of them outlive it.
  MasterBake(const BakeRequest& request, const SceneSources& sources, const BakePlan& plan, const OutputFolder& out,
             const BakeProgress& progress, StatusFeed& feed, BakeSummary& summary);

  /// Bakes what earlier bakes have not left in OUT, and publishes; the summary is complete.
  /// Errors  InputError: OUT/scene.xml is as it was.
  void run(MpiSession& mpi, BakeProcess& process);

 private:
  void plan_dispatch(const std::vector<CellReport>& done);
  std::size_t cells_among(const std::vector<CellReport>& reports) const;
  void forget_orphans();
  void publish();

  const BakeRequest& request_;
  const SceneSources& sources_;
  const BakePlan& plan_;
  const OutputFolder& out_;
  const BakeProgress& progress_;
  StatusFeed& feed_;
  BakeSummary& summary_;
  std::optional<Journal> journal_;
};

}  // namespace gigabake
