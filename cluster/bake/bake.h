/// A complete bake on all ranks: scan, plan, dispatch, merge, publish.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "cluster/bake/output_folder.h"
#include "cluster/bake/run_amounts.h"
#include "cluster/bake/shared_sources.h"
#include "cluster/edit/scene_edits.h"
#include "cluster/mpi/collective.h"
#include "cluster/mpi/mpi_session.h"
#include "cluster/process/child_process.h"
#include "core/base/progress.h"
#include "core/octree/parameters.h"
#include "format/job/run_work.h"
#include "format/scene/xml/scene_xml.h"
#include "format/source/source.h"
#include "scheduler/plan/plan.h"
#include "scheduler/queue/timeouts.h"
#include "scheduler/status/bake_event.h"
#include "scheduler/status/bake_status.h"
#include "worker/device/backend.h"

namespace gigabake {

struct BakeRequest {
  std::filesystem::path source, out;
  std::filesystem::path scratch;  ///< folder for the clusters of large tiles during the bake; empty: OUT/scratch
  SourceOptions source_options;   ///< its area and its raster are set on rank 0 only
  std::string area_text;          ///< the options of the area of interest; empty without one
  std::string raster_text;        ///< the options of elevation rasters; empty without one
  BakeParameters parameters;
  int threads = 0;                 ///< per rank; 0: the host's cores divided among its ranks
  std::uint64_t memory_bytes = 0;  ///< per rank; 0: no bound
  bool is_default_memory = false;  ///< memory_bytes is the default: a rank uses less if its host has less per rank
  bool keep_going = true;          ///< continue after a tile or cell failed
  bool overviews = true;           ///< write overview shards, which contain the levels above the cells
  Backend backend = Backend::automatic;
  bool prune = false;     ///< remove shards that the new scene does not use, if it is complete
  std::vector<int> gpus;  ///< devices of each host to use; empty: all
  Timeouts timeouts;
  std::string source_record;         ///< text of OUT/source.json after the bake; empty: the file remains unchanged
  std::optional<EditsChange> edits;  ///< change of OUT/edits.json by this bake; nullopt: the file remains unchanged
  std::filesystem::path metrics;     ///< file for rank 0's status in Prometheus format; empty: none
};

/// The caller's view of a bake.
struct BakeProgress {
  Progress steps;         ///< on every rank: receives the steps before the first cell, and may cancel
  BakeListener listener;  ///< on rank 0: receives the events in their order; may be empty
};

/// Results of a bake. Stage seconds are sums over cells; stages of consecutive cells overlap.
struct BakeSummary {
  SceneDescription scene;
  SourcePrecision precision;
  std::vector<LevelSummary> levels;   ///< of all cells of the scene, per lod
  std::vector<std::string> warnings;  ///< BakePlan::warnings
  BakeStatus status;                  ///< the status at the end of the bake
  double scan_s = 0, bake_s = 0, read_s = 0, kernel_s = 0, write_s = 0;
  RunAmounts amounts;                    ///< baked by this run
  RunWork work;                          ///< of all bake processes and rank 0
  std::optional<double> joules;          ///< of the processors of rank 0's host; nullopt: not measured
  std::uint64_t peak_kernel_bytes = 0;   ///< max over cells
  std::uint64_t bad_uv = 0;              ///< triangles with unusable texture coordinates, summed over this run's cells
  std::uint64_t peak_process_bytes = 0;  ///< max over bake processes and rank 0
  std::size_t cells_planned = 0, cells_empty = 0, cells_on_device = 0;
  std::size_t cells_taken_over = 0;  ///< reused from earlier bakes into OUT
  std::size_t lost_ranks = 0;        ///< ranks lost at the end; if there are any, no collective call may follow
  bool is_drained = false;           ///< the bake ended on request before all cells were baked
  int ranks_with_device = 0;
  std::string no_device;  ///< reason why rank 0 has no device
  int ranks = 1, threads = 1;
  OrphanShards orphans;  ///< kept in OUT, though the scene does not use them
  OrphanShards pruned;   ///< removed from OUT
};

/// Collective call. `early` is this rank's bake process, if start_early() has started it before MPI.
/// Locks OUT during the bake. Returns early once is_drain_requested() is true; if no cell has been
/// started by then, throws Stopped on every rank instead. The scene and the sums of the summary are filled on rank 0
/// only. The edits of the source apply first, then the edits of OUT/edits.json. OUT/edits.json and OUT/source.json
/// change only if the scene is published. OUT/scene.xml is replaced last. Shards that the new scene.xml does not name
/// are kept unless request.prune is set.
/// Errors  CollectiveFailure, with OUT/scene.xml unchanged: the source cannot be opened or has no triangles, OUT cannot
///         be written, or another bake has locked OUT. CollectiveFailure also if no cell could be baked, or if any
///         input is missing without keep_going.
BakeSummary bake(MpiSession& mpi, const BakeRequest& request, const BakeProgress& progress,
                 std::unique_ptr<ChildProcess> early = nullptr);

/// Result of plan_bake().
struct PlannedBake {
  BakePlan plan;  ///< on rank 0 only
  SharedSources sources;
  double scan_s = 0;  ///< seconds for opening the source, the scan and the plan
};

/// Collective call. Scans and plans only.
/// Errors  CollectiveFailure and Stopped, as bake(). Sources that bake() would refuse are refused here too.
PlannedBake plan_bake(MpiSession& mpi, const BakeRequest& request, const BakeProgress& progress);

}  // namespace gigabake
