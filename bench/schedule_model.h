/// A synthetic terrain of any size, and workers whose times have the distribution of real bakes.
#pragma once

#include <cstdint>
#include <vector>

#include "format/job/tile_scan.h"
#include "scheduler/queue/schedule.h"

namespace gigabake::bench {

// Source  Two bakes of `gigabake sample --size 1024 --seed 7`, --cell-voxels 512 --threads 1, on a virtual machine with
//         two busy cores: --voxel-size 0.125 (349 cells) and 0.0625 (1410 cells). Seconds are the sums of all three
//         stages.

/// The standard deviation of ln(seconds / estimated triangles). The two bakes have 0.70 and 0.55, and 0.33 and 0.43 in
/// the half of larger cells.
inline constexpr double sigma_of_seconds = 0.70;
/// The standard deviation of ln(estimated triangles). The two bakes have 1.76 and 1.04, because most cells at the
/// border are small. Their largest cells took 2.9 and 3.3 times the mean. The largest of 10^6 log-normal cells takes
/// about two hundred times the mean, so the model is harder than these bakes.
inline constexpr double sigma_of_triangles = 1.04;
inline constexpr double mean_triangles = 8600;
inline constexpr double seconds_per_triangle = 2.3e-5;
/// The fraction of a cell's seconds that each stage takes, measured with 0.125 m voxels.
inline constexpr double share_of_read = 0.015, share_of_kernels = 0.785, share_of_write = 0.20;

/// The delay of a message, in either direction. It is half of the 4 ms that a round trip over MPI takes when both sides
/// sleep 1 ms between polls.
inline constexpr double message_s = 0.002;
/// The assumed time from the death of a bake process until its successor accepts jobs.
inline constexpr double restart_s = 2;

struct StageTimes {
  double read_s = 0, kernels_s = 0, write_s = 0;
  double sum() const { return read_s + kernels_s + write_s; }
};

/// Returns the scans of a square terrain with one cell per column. A tile covers 10 × 10 columns and extends into the
/// next column to the east and north.
/// Exact   Equal on every machine except for the last bit of exp, log and cos.
std::vector<TileScan> terrain_scans(std::uint32_t cells, std::uint64_t seed);

/// Returns the true times of a cell, which the scheduler does not know. The mean over many cells is
/// seconds_per_triangle.
StageTimes true_times(const CellJob& job, std::uint64_t seed);

/// Returns a number in [0, 1) that is uniformly distributed over (seed, index).
double uniform(std::uint64_t seed, std::uint64_t index);

}  // namespace gigabake::bench
