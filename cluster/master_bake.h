/// What rank 0 does while cells are baked and after: keeps the status, merges the reports, publishes the scene.
#pragma once

#include <optional>
#include <vector>

#include "cluster/bake.h"
#include "cluster/dispatch.h"
#include "cluster/output_folder.h"
#include "cluster/status_feed.h"
#include "scheduler/journal.h"

namespace gigabake {

/// Throws where these losses leave the previous scene in place. Errors  InputError.
void refuse(const BakeRequest& request, const std::vector<SceneLoss>& losses, bool nothing_baked);

class MasterBake : private DispatchWatcher {
 public:
  /// All of them outlive it.
  MasterBake(const BakeRequest& request, const SceneSources& sources, const BakePlan& plan, const OutputFolder& out,
             const BakeProgress& progress, StatusFeed& feed, BakeSummary& summary);

  /// Bakes what earlier bakes have not left in OUT, and publishes; the summary is complete.
  /// Errors  InputError: OUT/scene.xml is as it was.
  void run(MpiSession& mpi, BakeProcess& process);

 private:
  bool turn() override;
  void joined(int rank, const std::string& host) override;
  void handed_out(std::uint32_t job, int rank) override;
  bool finished(const CellReport& report) override;
  void attempt_failed(std::uint32_t job) override;
  bool set_aside(const CellReport& report) override;
  void process_died(int rank, const std::string& why) override;
  void lost(int rank) override;

  void plan_dispatch(const std::vector<CellReport>& done);
  void write_down(const CellReport& report);
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
