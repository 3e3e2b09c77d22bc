/// How many cells a worker packs and writes at a time, and with how many threads.
#pragma once

#include "worker/cell_pipeline.h"

namespace gigabake {

struct WriteCrew {
  int writers;  ///< cells at a time, a thread each
  int threads;  ///< of the pool that their loops share; the calling writer is one of them, so it starts one less
};

/// Beside a device two to four cells are written at a time, with a pool for what comes to the host unpacked, in all no
/// more threads than the worker has. What a device has packed is only handed to the system, and HDF5 serves one writer
/// at a time: more than four wait for each other. Where memory is short there are fewer cells. Without a device the
/// kernels need the threads, and one cell is packed at a time.
WriteCrew write_crew_for(const WorkerOptions& options);

}  // namespace gigabake
