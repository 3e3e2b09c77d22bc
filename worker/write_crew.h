/// How many cells a worker packs and writes at a time, and with how many threads.
#pragma once

#include "worker/cell_pipeline.h"

namespace gigabake {

struct WriteCrew {
  int writers;  ///< cells at a time, a thread each
  int threads;  ///< of the pool that their loops share; the calling writer is one of them, so it starts one less
};

/// Beside a device packing sets the pace. Its loops are so short that waking many threads for one of them takes longer
/// than the loop: so two to eight cells are packed at a time with few threads each, in all no more than the worker has.
/// Where memory is short there are fewer cells. Without a device the kernels need the threads, and one cell is packed
/// at a time.
WriteCrew write_crew_for(const WorkerOptions& options);

}  // namespace gigabake
