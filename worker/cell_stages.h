/// What each of the pipeline's stages does with one cell. No threads, no queues: doing, apart from overlapping.
#pragma once

#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <shared_mutex>
#include <vector>

#include "format/job/cell_job.h"
#include "kernels/body/cell.h"
#include "kernels/cuda/baker.h"
#include "kernels/pack/packer.h"
#include "lattice/thread_pool.h"
#include "worker/cell_loader.h"
#include "worker/cell_pipeline.h"
#include "worker/overview_inputs.h"
#include "worker/parent_bake.h"

namespace gigabake {

/// A cell on its way through the stages.
struct CellInHand {
  explicit CellInHand(CellJob cell_job);

  CellJob job;
  CellReport report;
  bool decided = false;              ///< the report is final; later stages pass it on
  std::optional<LoadedCell> loaded;  ///< until there is a volume: a device may fail at any step
  ChildrenOfParent children;         ///< of a parent, instead
  std::shared_ptr<const kernels::CudaInput> device_input;
  std::unique_ptr<kernels::CudaVolume> device_volume;  ///< until it is packed, or on the host
  std::optional<kernels::PackedCell> packed;           ///< then there is no volume
  kernels::CellVolume volume;

  const kernels::CellStats& stats() const { return packed ? packed->stats : volume.stats; }
};

/// How many cells come from a device at a time: a cell's packing leaves most of it idle, and waits for it.
inline constexpr std::size_t bringers = 3;

/// Each stage may throw; the pipeline turns that into a failed report.
class CellStages {
 public:
  /// Errors  InputError when OUT/shards cannot be made.
  CellStages(SceneSources sources, BakeParameters parameters, const WorkerOptions& options);

  /// Starts the device's driver, on the thread that will read. What goes wrong shows again at the first cell.
  void prepare();
  /// Takes over a whole shard of this fingerprint if OUT has one; else loads tiles and textures, to the device too. Of
  /// a parent's children it takes what is in memory, and reads the rest.
  void read(CellInHand& cell);
  /// loaded → volume, on the device if there is one and it is no parent; a cell at which it fails is baked on the CPU,
  /// and the report says so.
  void compute(CellInHand& cell);
  /// What a device holds comes to the host, packed as columns there; where that is not to be had as a volume, for the
  /// host to pack. Decides for `empty` where no voxel is occupied. The next cell is computed meanwhile.
  /// bringer: who asks, at most `bringers`; each brings a cell of its own at the same time.
  void bring(CellInHand& cell, std::size_t bringer);
  /// Volume or columns → shard → report.
  void write(CellInHand& cell);

 private:
  void make_baker();
  template <class Step>
  bool on_device(CellInHand& cell, const Step& step);
  void bake_on_cpu(CellInHand& cell) const;
  void bake_parent(CellInHand& parent) const;
  void bring_from_device(CellInHand& cell, kernels::CudaPacker& packer);
  void pack_on_device(CellInHand& cell, kernels::CudaPacker& packer);
  void pack_beside_others(CellInHand& cell, kernels::CudaPacker& packer, kernels::PackRequest& request);
  void bring_volume(CellInHand& cell);
  bool is_alone_on_device(const kernels::CellStats& stats) const;
  void take_stats(CellInHand& cell) const;
  template <class AnyShard>
  void keep_for_overviews(const CellJob& job, AnyShard&& shard);
  ShardHeader header_of(const CellInHand& cell) const;
  template <class AnyShard>
  void report_shard(CellInHand& cell, const AnyShard& shard, const StoredShard& stored) const;

  const SceneSources sources_;
  const BakeParameters parameters_;
  const WorkerOptions options_;
  CellLoader loader_;
  OverviewInputs overview_inputs_;
  ThreadPool pool_, write_pool_;                               ///< several cells are written at a time
  std::unique_ptr<kernels::CudaBaker> cuda_;                   ///< made on the thread that reads
  std::vector<std::unique_ptr<kernels::CudaPacker>> packers_;  ///< of each bringer, and of who computes
  std::shared_mutex packing_;                                  ///< taken alone by who needs all of its memory
  std::mutex download_;                                        ///< which the baker does for one at a time
};

}  // namespace gigabake
