/// Times the kernels of one cell, backend by backend, and compares what they made.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "bench/bench_scene.h"
#include "kernels/body/cell.h"

namespace gigabake::bench {

struct KernelBenchRequest {
  BenchScene scene;
  int repeats = 5;                ///< the fastest whole run counts, after one that warms up
  bool cpu = true, cuda = false;  ///< which backends
};

/// One backend's fastest run.
struct BackendTimes {
  std::string backend;  ///< "cpu" or "cuda"
  kernels::CellStats stats;
  double total_s = 0;     ///< kernels alone: input and result stay in the backend's memory
  double transfer_s = 0;  ///< of upload and download, where there are any
  std::string content_hash;
};

struct KernelBench {
  std::string cell;
  std::uint64_t voxels_lod0 = 0, voxels = 0, bricks = 0;
  std::uint64_t input_bytes = 0;    ///< mesh and textures, once
  std::uint64_t output_bytes = 0;   ///< packed levels and nodes, once
  double copy_bytes_per_s = 0;      ///< of the device; 0 without one
  std::vector<BackendTimes> times;  ///< all of one content hash, or `differ`
  bool differ = false;

  /// Least time that reading the input and writing the output once takes on the device.
  double floor_s() const { return copy_bytes_per_s > 0 ? double(input_bytes + output_bytes) / copy_bytes_per_s : 0; }
};

/// The cell with the most triangles of the source's plan.
/// Errors  InputError: as a bake of it, or the cell has no voxels; UsageError: cuda without a device.
KernelBench bench_kernels(const KernelBenchRequest& request);

}  // namespace gigabake::bench
