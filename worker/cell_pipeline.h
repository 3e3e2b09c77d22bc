/// Bakes cells one after the other in overlapped stages: the next is read and decoded while the kernels compute this
/// one and the last is packed and written. A device packs by itself, beside its kernels, and what it packed comes to
/// the host in a stage of its own.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>

#include "format/job/cell_job.h"
#include "format/source/source.h"
#include "lattice/parameters.h"

namespace gigabake {

struct WorkerOptions {
  int threads = 1;  ///< of each stage; beside a device writing takes what the others leave
  std::uint64_t memory_bytes =
      0;                      ///< to aim for; a quarter caches tiles and textures, half is the kernels'. 0: no bound
  std::filesystem::path out;  ///< the bake's folder; shards go to OUT/shards
  std::optional<int> cuda_device = {};  ///< none: the kernels run on the CPU
  /// `threads` is this rank's part of the host's cores, and nobody asked for that number.
  bool threads_are_a_share = false;
  std::filesystem::path scratch = {};  ///< for tiles that are large beside memory_bytes; none: they stay in memory
};

/// Jobs are taken in the order of submission, and reported in it too but where a device bakes: there writing is by far
/// the longest stage, and several cells are written at a time (worker/write_crew.h).
/// Exact   A shard depends on its job, the sources and the parameters; not on threads, memory or other jobs.
/// Errors  Whatever goes wrong with a cell becomes its report: one line, and `refused` where another try would find the
///         same, else `failed`.
class CellPipeline {
 public:
  /// Makes OUT/shards. Errors  InputError when that fails.
  /// on_report: told, on a thread of the pipeline, that poll() has one report more.
  CellPipeline(SceneSources sources, BakeParameters parameters, const WorkerOptions& options,
               std::function<void()> on_report = {});
  /// Finishes the cells in hand and drops jobs that wait.
  ~CellPipeline();
  CellPipeline(const CellPipeline&) = delete;
  CellPipeline& operator=(const CellPipeline&) = delete;

  /// Returns at once. As many jobs in flight as scheduler/schedule.h keeps with a worker keep all stages busy.
  void submit(CellJob job);
  /// The next report, if one is there.
  std::optional<CellReport> poll();
  /// Submitted and not yet polled.
  std::size_t in_flight() const;

 private:
  class Stages;
  std::unique_ptr<Stages> stages_;
};

}  // namespace gigabake
