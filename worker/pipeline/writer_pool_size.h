/// Sizes of a worker's pools: the cells that it reads ahead, packs and writes concurrently, and the threads for them.
#pragma once

#include <cstddef>
#include <cstdint>

#include "worker/pipeline/cell_pipeline.h"

namespace gigabake {

struct WriterPoolSize {
  int writers;  ///< cells written concurrently, one thread each
  int threads;  ///< threads of the pool that the writers share, including the writer that calls it
};

/// Returns the number of writers and pool threads. If there is a device, two to four cells are written concurrently. A
/// shared pool packs cells that are read back unpacked. It has the threads that the writers and the other stages leave,
/// at least one. A cell that the device has packed is only written. HDF5 serves one writer at a time, so more than four
/// writers would wait for each other. If memory is short, fewer cells are written concurrently. Without a device there
/// is one writer, or two if at least four cells are computed concurrently; they share a pool of all threads.
WriterPoolSize writer_pool_size_for(const WorkerOptions& options);

/// Returns the number of cells that the CPU computes concurrently. A cell joins its threads several times, and some of
/// its steps run on one thread; threads that would wait compute another cell. It is one cell per two threads and per
/// GiB of memory, at most eight. It is 1 with a device, which computes one cell at a time.
std::size_t concurrent_cells_for(const WorkerOptions& options);

/// Returns the number of overviews made concurrently with a device. Most overviews become ready at the end of a bake,
/// and some steps of making an overview run on one thread.
std::size_t overview_makers_for(const WorkerOptions& options);

/// Returns the number of cells that are read concurrently. Most of the time for a tile's first cell is the decoding of
/// one image on one thread, so a device worker reads up to three cells at a time, if threads and memory suffice.
/// If `stored_only` is set, it is the same, because readers edit stored shards, partly on one thread. Otherwise it is 1
/// without a device, because reading and kernels share the threads.
std::size_t readers_for(const WorkerOptions& options);

/// Returns the number of cells read before a device needs them. A tile's first cell takes as long to read as several
/// cells take to bake; the device would wait for each tile without read-ahead. The number is lower if memory is short.
/// It is 0 without a device, because reading and kernels share the threads.
std::size_t readahead_cells_for(const WorkerOptions& options);

/// Returns the bytes of memory in which each writer may assemble a file: at most 64 MiB. All writers together use at
/// most 1/16 of the worker's memory.
std::uint64_t file_image_bytes_for(const WorkerOptions& options);

}  // namespace gigabake
