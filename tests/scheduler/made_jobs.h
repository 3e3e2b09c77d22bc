/// Cells for schedules, made from numbers without files.
#pragma once

#include <random>
#include <vector>

#include "format/job/cell_job.h"

namespace gigabake {

/// Returns a square of cells of 64 voxels; 3 × 3 of them share a tile. Costs are spread over three powers of ten.
inline std::vector<CellJob> made_jobs(std::uint32_t number, std::mt19937& random) {
  constexpr std::uint32_t side = 30;
  std::vector<CellJob> jobs(number);
  for (std::uint32_t i = 0; i < number; ++i) {
    const std::uint32_t x = i % side, y = i / side;
    jobs[i].id = i;
    jobs[i].cell_voxels = 64;
    jobs[i].lattice_min = {64 * std::int64_t(x) - 640, 64 * std::int64_t(y) - 640, 0};
    jobs[i].tiles = {y / 3 * side + x / 3};
    jobs[i].triangles = std::uint64_t(1) << random() % 10;
    jobs[i].triangles += random() % jobs[i].triangles;
  }
  return jobs;
}

inline std::vector<CellJob> equal_jobs(std::uint32_t number) {
  std::mt19937 random(1);
  std::vector<CellJob> jobs = made_jobs(number, random);
  for (CellJob& job : jobs) job.triangles = 100;
  return jobs;
}

}  // namespace gigabake
