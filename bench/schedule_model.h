/// A terrain as large as asked for, made of numbers alone, and workers whose seconds scatter as those of real bakes do.
#pragma once

#include <cstdint>
#include <vector>

#include "format/job/survey.h"
#include "scheduler/schedule.h"

namespace gigabake::bench {

// Source  Two bakes of `gigabake sample --size 1024 --seed 7`, --cell-voxels 512 --threads 1, on a virtual machine with
// two busy cores: --voxel-size 0.125 (349 cells) and 0.0625 (1410 cells). Seconds are those of all three stages.

/// Standard deviation of ln(seconds / estimated triangles): 0.70 and 0.55; 0.33 and 0.43 in the larger half.
inline constexpr double sigma_of_seconds = 0.70;
/// Of ln(estimated triangles): 1.76 and 1.04, mostly small cells at the border. The largest cells took 2.9 and 3.3
/// times the mean; those of a log-normal terrain of 10^6 cells take about two hundred times, so the model is harder.
inline constexpr double sigma_of_triangles = 1.04;
inline constexpr double mean_triangles = 8600;
inline constexpr double seconds_per_triangle = 2.3e-5;
/// Of a cell's seconds, in 0.125 m voxels.
inline constexpr double share_of_read = 0.015, share_of_kernels = 0.785, share_of_write = 0.20;

/// From sending a job to its receipt, or from sending a report: half of the 4 ms that a round trip over MPI takes when
/// both sides sleep 1 ms between polls.
inline constexpr double message_s = 0.002;
/// From the death of a baking process to the next one that takes jobs: an assumption.
inline constexpr double restart_s = 2;

struct StageTimes {
  double read_s = 0, kernels_s = 0, write_s = 0;
  double sum() const { return read_s + kernels_s + write_s; }
};

/// As many columns of one cell each, in a square; tiles cover 10 × 10 columns and reach into the next one to the east
/// and north. Exact  The same on every machine but for the last bit of exp, log and cos.
std::vector<TileSurvey> terrain_surveys(std::uint32_t cells, std::uint64_t seed);

/// What a cell takes in truth, which the scheduler does not know. The mean over many cells is seconds_per_triangle.
StageTimes true_times(const CellJob& job, std::uint64_t seed);

/// Uniform in [0, 1), one number for each (seed, index).
double uniform(std::uint64_t seed, std::uint64_t index);

}  // namespace gigabake::bench
