/// Times the kernels of one cell for each backend and compares the results.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "bench/bench_scene.h"
#include "kernels/body/cell.h"

namespace gigabake::bench {

struct KernelBenchRequest {
  BenchScene scene;
  int repeats = 5;                ///< the fastest whole run counts, after a warm-up run
  bool cpu = true, cuda = false;  ///< backends to run
};

/// The fastest run of one backend.
struct BackendTimes {
  std::string backend;  ///< "cpu" or "cuda"
  kernels::CellStats stats;
  double total_s = 0;     ///< kernels only: input and result stay in the backend's memory
  double transfer_s = 0;  ///< upload and download, if any
  std::string content_hash;
};

struct KernelBench {
  std::string cell;
  std::uint64_t voxels_lod0 = 0, voxels = 0, bricks = 0;
  std::uint64_t input_bytes = 0;    ///< mesh and textures, each counted once
  std::uint64_t output_bytes = 0;   ///< packed levels and nodes, each counted once
  double copy_bytes_per_s = 0;      ///< copy bandwidth of the device; 0 without a device
  std::vector<BackendTimes> times;  ///< content hashes are equal, or `differ` is set
  bool differ = false;

  /// Returns a lower bound of the time: reading the input and writing the output once on the device.
  double floor_s() const { return copy_bytes_per_s > 0 ? double(input_bytes + output_bytes) / copy_bytes_per_s : 0; }
};

/// Measures the cell with the most triangles of the source's plan.
/// Errors  InputError: as a bake, or the cell has no voxels. UsageError: cuda without a device.
KernelBench bench_kernels(const KernelBenchRequest& request);

}  // namespace gigabake::bench
