/// Bakes cells in overlapped stages. The next cell is read and decoded while the kernels compute the current one; the
/// previous cell is packed and written at the same time. A device packs cells itself, concurrently with its kernels; a
/// separate stage reads the packed cells back to the host. Without a device, several cells are computed concurrently on
/// one pool of threads.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>

#include "core/octree/parameters.h"
#include "format/job/cell_job.h"
#include "format/source/source.h"
#include "worker/overview/overview_bake.h"

namespace gigabake {

struct WorkerOptions {
  /// Threads per stage. If there is a device, the writers use the threads that the other stages leave.
  int threads = 1;
  /// Memory target: 1/4 for the caches of tiles and textures, 1/2 for the kernels. 0 means no limit.
  std::uint64_t memory_bytes = 0;
  std::filesystem::path out;            ///< the bake's folder; shards go to OUT/shards
  std::optional<int> cuda_device = {};  ///< nullopt: the kernels run on the CPU
  /// True if `threads` is this rank's share of the host's cores rather than a number that the user requested.
  bool threads_are_a_share = false;
  /// True if `memory_bytes` is the default rather than a number that the user requested. The memory of a device is then
  /// bounded by `device_bytes`.
  bool memory_is_default = false;
  /// Folder for tiles and textures that are large compared with memory_bytes. If empty, all stay in memory.
  std::filesystem::path scratch = {};
  /// Target for the memory of the device: 1/4 for textures, 1/4 for packing, 1/2 for the kernels. 0: `memory_bytes`.
  std::uint64_t device_bytes = 0;
  /// True if the pipeline makes only cells that need no kernels: overviews, and cells of stored shards.
  /// CellPipeline::take_unstored() returns the others.
  bool stored_only = false;
};

/// A pipeline that bakes submitted jobs in order. The order of the reports may differ, because several shards are
/// published at the same time.
/// Exact   A shard depends only on its job, the sources and the parameters, not on threads, memory or other jobs.
/// Errors  Errors of a cell are not thrown: the cell's report holds the error as one line. The outcome is `refused` if
///         another attempt would fail the same way, else `failed`.
class CellPipeline {
 public:
  /// Creates OUT/shards. The pipeline calls `on_report` on one of its threads whenever poll() has one more report.
  /// Errors  InputError: OUT/shards cannot be created.
  CellPipeline(SceneSources sources, BakeParameters parameters, const WorkerOptions& options,
               std::function<void()> on_report = {});
  /// Finishes the cells in flight and drops queued jobs.
  ~CellPipeline();
  CellPipeline(const CellPipeline&) = delete;
  CellPipeline& operator=(const CellPipeline&) = delete;

  /// Queues a job and returns immediately. The number of jobs in flight that scheduler/queue/schedule.h allows per
  /// worker keeps all stages busy.
  void submit(CellJob job);
  /// Returns the next report, if any.
  std::optional<CellReport> poll();
  /// Returns the next job whose cell must be baked from its source, if any; it gets no report. Only with
  /// WorkerOptions::stored_only; `on_report` is called for it, too.
  std::optional<CellJob> take_unstored();
  /// Returns the data of a baked shard that its overview needs; null if it is no longer in memory.
  std::shared_ptr<const OverviewChild> find_child(const std::string& file);
  /// Takes the data of a shard that another worker has baked. Call it before submitting the overview.
  void keep_child(const std::string& file, OverviewChild child);
  /// Returns the number of jobs submitted and not yet polled.
  std::size_t in_flight() const;

 private:
  class Stages;
  std::unique_ptr<Stages> stages_;
};

}  // namespace gigabake
