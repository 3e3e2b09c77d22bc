/// Bakes cells in overlapped stages. The next cell is read and decoded while the kernels compute the current one; the
/// previous one is packed and written at the same time. A device packs cells itself, concurrently with its kernels; a
/// separate stage reads the packed cells back to the host.
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

namespace gigabake {

struct WorkerOptions {
  int threads = 1;                 ///< per stage; with a device, writing uses the threads that the other stages leave
  std::uint64_t memory_bytes = 0;  ///< target; a quarter caches tiles and textures, half is for kernels. 0: no bound
  std::filesystem::path out;       ///< the bake's folder; shards go to OUT/shards
  std::optional<int> cuda_device = {};  ///< none: the kernels run on the CPU
  /// True if `threads` is this rank's share of the host's cores rather than a number that the user requested.
  bool threads_are_a_share = false;
  std::filesystem::path scratch = {};  ///< for tiles that are large compared with memory_bytes; empty: memory only
};

/// Bakes submitted jobs in order. Reports have the same order, except with a device. Writing is then by far the slowest
/// stage, and several cells are written concurrently (worker/pipeline/writer_pool_size.h).
/// Exact   A shard depends on its job, the sources and the parameters; not on threads, memory or other jobs.
/// Errors  Every error of a cell becomes its report with one line of text: `refused` if another attempt would fail the
///         same way, else `failed`.
class CellPipeline {
 public:
  /// Creates OUT/shards. on_report: called on a thread of the pipeline when poll() has one more report.
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
  /// Returns the number of jobs submitted and not yet polled.
  std::size_t in_flight() const;

 private:
  class Stages;
  std::unique_ptr<Stages> stages_;
};

}  // namespace gigabake
