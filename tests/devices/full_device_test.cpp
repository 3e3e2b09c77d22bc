// If a device has no memory for packing, the bake reports one note per cell and writes the same files. The test is
// skipped, with the reason, if there is no GPU.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <iterator>
#include <map>

#include "kernels/cuda/baker.h"
#include "tests/worker/glb_scene.h"
#include "worker/pipeline/cell_pipeline.h"
#include "worker/scan/scan_tile.h"

namespace gigabake {
namespace {

std::string bytes_of(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// Returns a job for each column that the tile overlaps; the ground's height fits one cell.
std::vector<CellJob> jobs_on_ground(const SceneSources& sources, const BakeParameters& parameters) {
  std::vector<CellJob> jobs;
  for (const ColumnExtent& column : scan_tile(sources, 0, parameters, callers_thread()).columns) {
    CellJob job;
    job.id = std::uint32_t(jobs.size());
    job.name = "c_" + std::to_string(column.column_x) + "_" + std::to_string(column.column_y) + "_0";
    const std::int64_t edge = parameters.cell_voxels;
    job.lattice_min = {column.column_x * edge, column.column_y * edge, -edge / 2};
    job.cell_voxels = parameters.cell_voxels;
    job.tiles = {0};
    job.fingerprint = {job.id + 1, 42};
    jobs.push_back(job);
  }
  return jobs;
}

TEST(FullDevice, HasItsCellsPackedOnTheHostAndSaysSo) {
  const ScratchFolder folder;
  write_glb(folder.path() / "tile0.glb", rolling_ground(32, 0, 0));
  const SceneSources sources = sources_of(folder.path(), {"tile0.glb"});
  BakeParameters parameters;
  parameters.voxel_size_m = 0.25;
  parameters.cell_voxels = 64;
  const std::vector<CellJob> jobs = jobs_on_ground(sources, parameters);
  const auto bake = [&](const char* out, std::uint64_t memory, std::optional<int> device) {
    CellPipeline pipeline(sources, parameters, {2, memory, folder.path() / out, device});
    return bake_all(pipeline, jobs);
  };
  std::map<std::uint32_t, CellOutcome> on_host;
  for (const CellReport& report : bake("host", 0, std::nullopt)) on_host[report.id] = report.outcome;
  ASSERT_GE(std::ranges::count(on_host, CellOutcome::baked, [](const auto& cell) { return cell.second; }), 2);
  const kernels::CudaDevices devices = kernels::cuda_devices();
  if (devices.usable.empty()) GTEST_SKIP() << devices.reason;
  // The packers get a quarter of this memory, too little for any cell. The kernels may use more than this memory.
  constexpr std::uint64_t little = 1 << 16;
  const std::vector<CellReport> reports = bake("device", little, devices.usable[0]);
  ASSERT_EQ(reports.size(), jobs.size());
  for (const CellReport& report : reports) {
    EXPECT_EQ(report.outcome, on_host[report.id]) << report.error;
    if (report.outcome != CellOutcome::baked) continue;
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
