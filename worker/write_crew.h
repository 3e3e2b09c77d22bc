/// How many cells a worker has read ahead, how many it packs and writes at a time, and with how many threads.
#pragma once

#include <cstddef>
#include <cstdint>

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

/// Returns how many overviews are made concurrently beside a device: most become ready at the end of a bake, and parts
/// of each run on one thread.
std::size_t overview_makers_for(const WorkerOptions& options);

/// Cells that are read before a device asks for them: a tile's first cell takes as long to read as several take to
/// bake, and the device would wait for each tile. Where memory is short there are fewer, and without a device none,
/// because reading and kernels share the threads.
std::size_t cells_ahead_for(const WorkerOptions& options);

/// Memory in which each writer may make a file: a sixteenth of the worker's for all of them.
std::uint64_t image_bytes_for(const WorkerOptions& options);

}  // namespace gigabake
