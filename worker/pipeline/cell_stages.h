/// The work of each pipeline stage on one cell. It has no threads and no queues; cell_pipeline.h overlaps the stages.
#pragma once

#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <shared_mutex>
#include <vector>

#include "core/base/thread_pool.h"
#include "format/area/area_in_scene.h"
#include "format/edit/edits_in_scene.h"
#include "format/job/cell_job.h"
#include "format/job/fingerprint.h"
#include "format/system/publish.h"
#include "kernels/body/cell.h"
#include "kernels/cuda/baker.h"
#include "kernels/pack/packer.h"
#include "worker/edit/cell_edits.h"
#include "worker/overview/overview_bake.h"
#include "worker/overview/overview_inputs.h"
#include "worker/pipeline/cell_loader.h"
#include "worker/pipeline/cell_pipeline.h"
#include "worker/pipeline/live_count.h"

namespace gigabake {

/// A cell in flight through the stages.
struct InFlightCell {
  explicit InFlightCell(CellJob cell_job);

  CellJob job;
  CellReport report;
  bool is_final = false;     ///< the report is final; later stages skip the cell
  bool is_unstored = false;  ///< with stored_only: the cell must be baked from its source
  /// Kept until the cell is packed or its volume is on the host. If the device fails before that, the CPU bakes from
  /// this data.
  std::optional<LoadedCell> loaded;
  std::unique_ptr<const CellEdits> edits;  ///< null if no edit selects a voxel of the cell
  kernels::LevelEdits edit_functions;      ///< of `edits`
  OverviewChildren children;               ///< input of an overview, instead of `loaded`
  std::shared_ptr<const kernels::CudaInput> device_input;
  std::unique_ptr<kernels::CudaVolume> device_volume;  ///< kept until it is packed or on the host
  std::shared_ptr<const void> volume_count;            ///< counts `device_volume` in CellStages::volumes_
  std::optional<kernels::PackedCell> packed;           ///< if set, `volume` is empty
  kernels::CellVolume volume;
  std::unique_ptr<Publication> publication;  ///< of the written shard, until it is published

  const kernels::CellStats& stats() const { return packed ? packed->stats : volume.stats; }
};

/// Number of cells that are read back from a device concurrently. Packing only one cell at a time would leave most of
/// the device idle.
inline constexpr std::size_t readback_workers = 3;

/// The stages of a pipeline. Each stage may throw; the pipeline turns the exception into a failed report.
class CellStages {
 public:
  /// Errors  InputError: OUT/shards cannot be created.
  CellStages(SceneSources sources, BakeParameters parameters, const WorkerOptions& options);

  /// Initializes the device, while another thread may read the first cell. An error is ignored, because read() of the
  /// first cell reports it again.
  void prepare();
  /// Reuses the shard of the job's fingerprint if OUT has a valid one. If OUT has a shard of the cell with fewer edits,
  /// applies the others to it (worker/edit/shard_edit.h) and writes the new shard. Otherwise loads tiles and textures,
  /// and uploads them to the device if there is one. For an overview, takes children from the cache where available and
  /// reads the others from OUT. Several threads may call it for different cells. If stored_only is set, loads no
  /// tiles, but sets `is_unstored`.
  void read(InFlightCell& cell);
  /// Computes the volume from the loaded data: on the device if there is one and the cell is not an overview. If the
  /// device fails, the cell is baked on the CPU, and the report has a note.
  void compute(InFlightCell& cell);
  /// Waits until a cell like the previous ones fits into device memory next to the cells that are not read back yet.
  /// Call it before compute(), in the same thread.
  void wait_for_device_memory();
  /// Reads a cell back from the device, packed as columns. If packing fails, reads the volume back for the host to
  /// pack. Sets the outcome `empty` if no voxel is occupied. May run while the next cell is computed.
  /// `readback_worker`, below readback_workers, selects the packer. Concurrent calls for cells on the device need
  /// different values.
  void read_back(InFlightCell& cell, std::size_t readback_worker);
  /// Computes the volume from the voxels of a stored shard of the cell that are inside the area. Sets the outcome
  /// `empty` if no voxel is inside.
  void clip(InFlightCell& cell, const ShardReader& shard) const;
  /// Writes the volume or the columns to a temporary shard, and fills the report.
  void write(InFlightCell& cell);
  /// Publishes the shard and flushes it to disk. Several threads may call it for different cells.
  void publish(InFlightCell& cell);
  OverviewInputs& overview_inputs() { return overview_inputs_; }

 private:
  void make_baker();
  template <class Step>
  bool on_device(InFlightCell& cell, const Step& step);
  void bake_on_cpu(InFlightCell& cell) const;
  void find_edits(InFlightCell& cell) const;
  /// Claims the memory of the voxels that edits fill.
  /// Errors  InputError: the memory limit is exceeded.
  static void claim_filled_voxels(const CellEdits& edits, const CellJob& job, MemoryClaim& memory);
  bool edit_stored(InFlightCell& cell) const;
  bool edit_stored(InFlightCell& cell, const CellJob& earlier, std::size_t applied) const;
  kernels::CellParameters parameters_of(const InFlightCell& cell, std::uint64_t memory_bytes) const;
  /// Returns whether the area of interest contains all voxels of the cell.
  bool is_wholly_inside(const CellJob& job) const;
  bool has_levels(const CellJob& job) const;
  void bake_overview(InFlightCell& overview) const;
  std::unique_ptr<kernels::CudaVolume> bake_on_device(const InFlightCell& cell);
  void read_back_from_device(InFlightCell& cell, kernels::CudaPacker& packer);
  void pack_on_device(InFlightCell& cell, kernels::CudaPacker& packer);
  void pack_beside_others(InFlightCell& cell, kernels::CudaPacker& packer, kernels::PackRequest& request);
  void read_back_volume(InFlightCell& cell);
  void take_stats(InFlightCell& cell) const;
  template <class AnyShard>
  void keep_for_overviews(const CellJob& job, AnyShard&& shard);
  ShardHeader header_of(const InFlightCell& cell) const;
  template <class AnyShard>
  void report_shard(InFlightCell& cell, const AnyShard& shard, const StoredShard& stored) const;

  const SceneSources sources_;
  const BakeParameters parameters_;
  const WorkerOptions options_;
  std::optional<AreaInScene> area_;
  std::optional<EditsInScene> edits_;
  std::optional<CellFingerprints> fingerprints_;  ///< if there are edits
  CellLoader loader_;
  std::mutex uploading_;  ///< the device takes the cells of several readers one at a time
  OverviewInputs overview_inputs_;
  ThreadPool pool_, write_pool_;  ///< write_pool_: shared by concurrent writers
  LiveCount volumes_;             ///< volumes on the device, from compute() to the end of read_back()
  std::mutex making_device_;      ///< guards the creation of the next two members
  std::unique_ptr<kernels::CudaBaker> cuda_;
  std::vector<std::unique_ptr<kernels::CudaPacker>> packers_;  ///< one per readback worker
  /// Shared while a cell is packed with a fraction of the memory; exclusive while one is packed with all of it.
  std::shared_mutex packing_;
  std::mutex download_;  ///< serializes CudaBaker::download()
};

}  // namespace gigabake
