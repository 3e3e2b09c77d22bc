/// State of a bake on one rank. The steps of bake.cpp fill it in the order of its members.
#pragma once

#include <chrono>
#include <optional>
#include <vector>

#include "cluster/bake/bake.h"
#include "cluster/bake/bake_scratch.h"
#include "cluster/bake/output_folder.h"
#include "cluster/bake/shared_sources.h"
#include "cluster/bake/status_feed.h"
#include "cluster/mpi/mpi_session.h"
#include "cluster/process/bake_process.h"
#include "format/job/tile_scan.h"
#include "scheduler/plan/plan.h"

namespace gigabake {

/// The state of bake() or plan_bake(). plan_bake() sets neither `feed` nor `out`. Members are destroyed in reverse
/// order: the bake process ends before its scratch folder is removed and OUT is unlocked.
struct BakeSession {
  BakeSession(MpiSession& of_ranks, const BakeRequest& agreed, const BakeProgress& listener,
              StatusFeed* status = nullptr)
      : mpi(of_ranks), request(agreed), progress(listener), feed(status) {}

  /// Passes an event to the status feed and to the caller's listener. Call it on rank 0 only.
  void report(const BakeEvent& event) const {
    if (feed != nullptr) feed->take(event);
    if (progress.listener) progress.listener(event);
  }

  MpiSession& mpi;
  BakeRequest request;  ///< equal on all ranks; open_source() adds the levels of the sources to its parameters
  const BakeProgress& progress;
  StatusFeed* feed;  ///< on rank 0 of a bake
  std::chrono::steady_clock::time_point start = std::chrono::steady_clock::now();
  EditsChange edits;  ///< on rank 0
  SharedSources sources;
  std::optional<OutputFolder> out;  ///< on rank 0 of a bake
  std::optional<BakeScratch> scratch;
  std::optional<BakeProcess> process;
  std::vector<TileScan> scans;  ///< on rank 0, from the scan to the plan
  BakePlan plan;                ///< on rank 0
  BakeSummary summary;
};

}  // namespace gigabake
