// A device that has no memory left to pack in: one line for each cell, the same files. Skipped, with the reason, where
// there is no GPU.
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <iterator>

#include "kernels/cuda/baker.h"
#include "tests/worker/glb_scene.h"
#include "worker/cell_pipeline.h"

namespace gigabake {
namespace {

std::string bytes_of(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// Cells side by side on rolling ground.
std::vector<CellJob> jobs_on_ground(std::uint32_t count, std::uint32_t cell_voxels) {
  std::vector<CellJob> jobs(count);
  for (std::uint32_t i = 0; i < count; ++i) {
    jobs[i].id = i;
    jobs[i].name = "c_" + std::to_string(i) + "_0_0";
    jobs[i].lattice_min = {std::int64_t(i) * cell_voxels, 0, -std::int64_t(cell_voxels) / 2};
    jobs[i].cell_voxels = cell_voxels;
    jobs[i].tiles = {0};
    jobs[i].fingerprint = {i + 1, 42};
  }
  return jobs;
}

TEST(FullDevice, HasItsCellsPackedOnTheHostAndSaysSo) {
  const kernels::CudaDevices devices = kernels::cuda_devices();
  if (devices.usable.empty()) GTEST_SKIP() << devices.reason;
  const ScratchFolder folder;
  write_glb(folder.path() / "tile0.glb", rolling_ground(32, 0, 0));
  const SceneSources sources = sources_of(folder.path(), {"tile0.glb"});
  BakeParameters parameters;
  parameters.voxel_size_m = 0.25;
  parameters.cell_voxels = 64;
  const std::vector<CellJob> jobs = jobs_on_ground(3, parameters.cell_voxels);
  const auto bake = [&](const char* out, std::uint64_t memory, std::optional<int> device) {
    CellPipeline pipeline(sources, parameters, {2, memory, folder.path() / out, device});
    return bake_all(pipeline, jobs);
  };
  // A quarter is the packers': too little for any cell, while kernels have more than they are told of.
  constexpr std::uint64_t little = 1 << 16;
  bake("host", 0, std::nullopt);
  const std::vector<CellReport> reports = bake("device", little, devices.usable[0]);
  ASSERT_EQ(reports.size(), jobs.size());
  for (const CellReport& report : reports) {
    EXPECT_EQ(report.outcome, CellOutcome::baked) << report.error;
    EXPECT_TRUE(report.on_device);
    EXPECT_EQ(report.note.rfind("packed on the CPU, because the GPU has not enough memory: ", 0), 0u) << report.note;
    EXPECT_EQ(report.note.find('\n'), std::string::npos);
    const std::string shard = bytes_of(folder.path() / "device" / report.cell.file);
    EXPECT_FALSE(shard.empty());
    EXPECT_TRUE(shard == bytes_of(folder.path() / "host" / report.cell.file)) << report.cell.name;
  }
  for (const CellReport& report : bake("room", 0, devices.usable[0])) EXPECT_EQ(report.note, "");
}

}  // namespace
}  // namespace gigabake
