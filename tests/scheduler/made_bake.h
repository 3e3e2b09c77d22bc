/// A folder with cells and the reports of a bake, for tests of files that a bake leaves.
#pragma once

#include <filesystem>
#include <fstream>
#include <random>
#include <string>
#include <vector>

#include "scheduler/plan/plan.h"

namespace gigabake {

/// A temporary folder that is removed with the test.
class TestFolder {
 public:
  TestFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "gigabake_test_XXXXXX").string();
    path_ = ::mkdtemp(name.data());
  }
  ~TestFolder() {
    std::error_code error;
    std::filesystem::remove_all(path_, error);
  }
  TestFolder(const TestFolder&) = delete;
  TestFolder& operator=(const TestFolder&) = delete;
  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

inline void write_text(const std::filesystem::path& path, const std::string& content) {
  std::filesystem::create_directories(path.parent_path());
  std::ofstream(path, std::ios::binary) << content;
}

inline std::string read_text(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// Returns cells whose fingerprints are made of `version` and their number.
inline BakePlan made_plan(std::uint32_t cells, std::uint64_t version = 1) {
  BakePlan plan;
  for (std::uint32_t i = 0; i < cells; ++i) {
    CellJob job;
    job.id = i;
    job.name = "c_" + std::to_string(i) + "_0_0";
    job.lattice_min = {64 * std::int64_t(i), 0, 0};
    job.cell_voxels = 64;
    job.fingerprint = {i + 1, version};
    plan.jobs.push_back(job);
  }
  return plan;
}

/// Writes a shard of a few bytes and reports it as a worker does.
inline CellReport bake_cell_of_text(const CellJob& job, const std::filesystem::path& out) {
  CellReport r;
  r.id = job.id;
  r.outcome = CellOutcome::baked;
  write_text(out / shard_path(job), "shard of " + job.name);
  r.shard = stamp_of(out / shard_path(job)).value();
  r.cell = {job.name,
            shard_path(job).generic_string(),
            job.lattice_min,
            job.cell_voxels,
            4,
            r.shard.size,
            7,
            {1, 2},
            job.fingerprint,
            {{3, 4}}};
  r.read_s = 1.5;
  return r;
}

inline CellReport empty_cell(const CellJob& job) {
  CellReport r;
  r.id = job.id;
  r.outcome = CellOutcome::empty;
  return r;
}

}  // namespace gigabake
