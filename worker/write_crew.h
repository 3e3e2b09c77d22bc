/// How many cells a worker packs and writes at a time, and with how many threads.
#pragma once

#include "worker/cell_pipeline.h"

namespace gigabake {

struct WriteCrew {
  int writers;  ///< cells at a time, a thread each
  int threads;  ///< of the pool that their loops share, besides the writers themselves one less
};

/// Beside a device packing sets the pace, and a loop that many threads share is shorter than their waking up: so, many
/// cells by few threads each, and all of them no more than the worker's threads. Where memory is short, few cells.
/// Without a device kernels want the threads: one cell, whose loops end soon.
WriteCrew write_crew_for(const WorkerOptions& options);

}  // namespace gigabake
