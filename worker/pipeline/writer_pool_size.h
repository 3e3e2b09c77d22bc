/// Numbers of cells that a worker reads ahead, and packs and writes concurrently, and of their threads.
#pragma once

#include <cstddef>
#include <cstdint>

#include "worker/pipeline/cell_pipeline.h"

namespace gigabake {

struct WriterPoolSize {
  int writers;  ///< cells written concurrently, one thread each
  int threads;  ///< of the pool shared by their loops; the calling writer counts as one, so the pool starts one less
};

/// Returns the number of writers and pool threads. If there is a device, two to four cells are written concurrently. A
/// shared pool packs cells that are read back unpacked; in all the stages use no more threads than the worker has.
/// Cells packed on the device are only passed to the system. HDF5 serves one writer at a time, so more than four
/// writers would wait for each other. If memory is short, fewer cells are written concurrently. Without a device the
/// kernels need the threads, and one cell is packed at a time.
WriterPoolSize writer_pool_size_for(const WorkerOptions& options);

/// Returns the number of overviews made concurrently with a device. Most overviews become ready at the end of a bake,
/// and parts of each run on one thread.
std::size_t overview_makers_for(const WorkerOptions& options);

/// Returns the number of cells read before a device needs them. A tile's first cell takes as long to read as several
/// take to bake, so without read-ahead the device would wait for each tile. The number is lower if memory is short. It
/// is 0 without a device, because reading and kernels share the threads.
std::size_t readahead_cells_for(const WorkerOptions& options);

/// Returns the memory in which each writer may assemble a file; all writers together use at most 1/16 of the worker's.
std::uint64_t file_image_bytes_for(const WorkerOptions& options);

}  // namespace gigabake
