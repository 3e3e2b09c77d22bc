/// A whole bake on all ranks: survey, plan, dispatch, merge, publish.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "cluster/collective.h"
#include "cluster/mpi_session.h"
#include "cluster/output_folder.h"
#include "cluster/shared_sources.h"
#include "format/scene/scene_xml.h"
#include "format/source/source.h"
#include "lattice/parameters.h"
#include "lattice/progress.h"
#include "scheduler/bake_status.h"
#include "scheduler/patience.h"
#include "scheduler/plan.h"
#include "worker/backend.h"

namespace gigabake {

struct BakeRequest {
  std::filesystem::path source, out;
  std::filesystem::path scratch;  ///< where large tiles' clusters stand while cells are baked; empty: OUT/scratch
  SourceOptions source_options;
  BakeParameters parameters;
  int threads = 0;                 ///< of each rank; 0: the host's cores shared by its ranks
  std::uint64_t memory_bytes = 0;  ///< of each rank; 0: no bound
  bool memory_is_usual = false;    ///< nobody asked for that much: a rank takes less where its host has less for it
  bool keep_going = true;          ///< after a tile or cell failed
  bool overviews = true;           ///< write overview shards, which contain the levels above the cells
  Backend backend = Backend::automatic;
  bool prune = false;     ///< remove shards that the new scene does not have, where it misses nothing
  std::vector<int> gpus;  ///< devices of each host to use; empty: all
  Patience patience;
  std::filesystem::path metrics;  ///< rank 0's status as Prometheus reads it; empty: none
};

/// Told to rank 0 alone, in the order in which it happens, but for the steps.
struct BakeProgress {
  Progress steps;  ///< of every rank: what it does before the first cell
  std::function<void(const SceneSources&)> opened;
  std::function<void(std::size_t done, std::size_t all)> surveyed;  ///< of a plan; a bake's status has it
  std::function<void(const BakePlan&)> planned;
  std::function<void(const BakeStatus&)> status;  ///< ten times a second
  std::function<void(const CellReport&, const CellJob&)> cell_done;
  std::function<void(const std::string&)> told;   ///< one line on what is normal
  std::function<void(const std::string&)> noted;  ///< one line that somebody should read, though the bake goes on
};

/// Stage seconds are sums over cells; stages of consecutive cells overlap.
struct BakeSummary {
  SceneDescription scene;
  SourcePrecision precision;
  std::vector<LevelSummary> levels;   ///< of all cells of the scene, per lod
  std::vector<std::string> warnings;  ///< BakePlan::warnings
  BakeStatus status;                  ///< at the end
  double survey_s = 0, bake_s = 0, read_s = 0, kernel_s = 0, write_s = 0;
  std::uint64_t peak_kernel_bytes = 0;   ///< of the largest cell
  std::uint64_t bad_uv = 0;              ///< in the cells of this run: one that crosses cells counts in each
  std::uint64_t peak_process_bytes = 0;  ///< of the largest bake process, or rank 0
  std::size_t cells_planned = 0, cells_empty = 0, cells_on_device = 0;
  std::size_t cells_taken_over = 0;  ///< from earlier bakes into OUT
  std::size_t lost_ranks = 0;        ///< that were not heard of again: no collective call may follow
  bool is_drained = false;           ///< ended on request with cells left
  int ranks_with_device = 0;
  std::string no_device;  ///< why rank 0 has none
  int ranks = 1, threads = 1;
  OrphanShards orphans;  ///< kept in OUT, though the scene does not have them
  OrphanShards pruned;   ///< removed from OUT
};

/// Collective; ends early once is_drain_asked(), before the first cell by Stopped on every rank. Scene and sums are
/// rank 0's; other ranks get empty ones. OUT is locked meanwhile. OUT/scene.xml is replaced last; shards that it does
/// not name stay unless request.prune. Errors  CollectiveFailure, and OUT/scene.xml is as it was: a source that cannot
/// be opened or has no triangles, an
///         OUT that cannot be written or that another bake holds, nothing that could be baked, or any loss without
///         keep_going.
BakeSummary bake(MpiSession& mpi, const BakeRequest& request, const BakeProgress& progress);

/// What a bake would do.
struct PlannedBake {
  BakePlan plan;  ///< rank 0's
  SharedSources sources;
  double survey_s = 0;  ///< opening, survey and plan
};

/// Collective: survey and plan alone. Errors  CollectiveFailure and Stopped, as bake(): what it would refuse
/// because of its sources is refused here.
PlannedBake plan_bake(MpiSession& mpi, const BakeRequest& request, const BakeProgress& progress);

}  // namespace gigabake
