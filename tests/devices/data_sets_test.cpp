// Bakes every source of the shared data and the sample terrain on CPU and GPU, with every surface rule and MIP filter.
// All levels must have the same content hash. The tests are skipped, with the reason, if there is no GPU or no data.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <gtest/gtest.h>
#include <iostream>
#include <set>

#include "core/base/error.h"
#include "format/shard/levels/content_hash.h"
#include "format/source/source.h"
#include "format/system/host_limits.h"
#include "kernels/cuda/baker.h"
#include "sample/sample.h"
#include "scheduler/plan/plan.h"
#include "tests/shared_data.h"
#include "worker/pipeline/cell_loader.h"
#include "worker/pipeline/cell_parameters.h"
#include "worker/pipeline/shard_from_volume.h"
#include "worker/scan/scan_tile.h"

namespace gigabake {
namespace {

using Path = std::filesystem::path;

constexpr double voxels_along = 300;  ///< along the scene's longest edge
constexpr std::size_t max_cells = 12;
constexpr std::uint64_t few_bytes = std::uint64_t(4) << 20;  ///< device memory; larger cells are split

using test::shared_data;

/// Returns the longest edge of the tiles' box in the scene, metres; 0 if nothing can be read.
double max_edge_m(const SceneSources& sources) {
  double low[3] = {1e300, 1e300, 1e300}, high[3] = {-1e300, -1e300, -1e300};
  for (const TileRef& tile : sources.tiles) {
    TileMesh mesh;
    try {
      mesh = read_tile(tile, sources.root, ReadScope::positions_only);
    } catch (const InputError&) {
      continue;
    }
    for (const Instance& instance : mesh.instances) {
      const std::vector<float>& p = mesh.primitives[std::size_t(instance.primitive)].position;
      for (std::size_t i = 0; i + 2 < p.size(); i += 3) {
        const Point<Scene> q = instance.scene_from_local({p[i], p[i + 1], p[i + 2]});
        const double xyz[3] = {q.x, q.y, q.z};
        for (int c = 0; c < 3 && std::isfinite(q.x + q.y + q.z); ++c) {
          low[c] = std::min(low[c], xyz[c]);
          high[c] = std::max(high[c], xyz[c]);
        }
      }
    }
  }
  return std::max({0.0, high[0] - low[0], high[1] - low[1], high[2] - low[2]});
}

struct Outcome {
  int sources = 0, without_cells = 0, cells = 0, comparisons = 0;
};

std::vector<Hash128> hashes(kernels::CellVolume volume, const CellJob& job, const BakeParameters& parameters) {
  if (volume.levels.empty()) return {};
  ShardHeader header;
  header.lattice_min = job.lattice_min;
  header.cell_voxels = job.cell_voxels;
  header.has_normals = parameters.normals;
  const Shard shard = shard_from_volume(std::move(volume), header);
  const std::vector<Hash128> of_voxels = content_hash(shard);
  EXPECT_EQ(shard.header.content_hash, of_voxels) << job.name << ": the backend's own hash is not that of its voxels";
  return of_voxels;
}

class OnBothBackends {
 protected:
  void find_device() {
    const kernels::CudaDevices devices = kernels::cuda_devices();
    reason_ = devices.reason;
    if (!devices.usable.empty())
      baker_ = std::make_unique<kernels::CudaBaker>(devices.usable[0], std::uint64_t(64) << 20);
  }

  void compare(const Path& source, Outcome& outcome) {
    SceneSources sources;
    try {
      sources = open_sources(source, {});
    } catch (const std::exception&) {
      return;  // tested in tests/format
    }
    BakeParameters parameters;
    parameters.voxel_size_m = std::clamp(max_edge_m(sources) / voxels_along, 1e-6, 1e6);
    parameters.cell_voxels = 256;
    std::vector<TileScan> scans;
    for (std::uint32_t t = 0; t < sources.tiles.size(); ++t) scans.push_back(scan_tile(sources, t, parameters, pool_));
    BakePlan plan = make_plan(std::move(scans), sources, parameters);
    ++outcome.sources;
    outcome.without_cells += plan.jobs.empty();
    if (plan.jobs.size() > max_cells) plan.jobs.resize(max_cells);
    CellLoader loader(sources, parameters, std::uint64_t(1) << 30, pool_.threads());
    for (const CellJob& job : plan.jobs) compare_cell(loader, job, parameters, outcome);
  }

 private:
  void compare_cell(CellLoader& loader, const CellJob& job, BakeParameters parameters, Outcome& outcome) {
    LoadedCell cell;
    try {
      cell = loader.load(job);
    } catch (const InputError&) {
      return;  // the cell has an image that cannot be decoded
    }
    ++outcome.cells;
    for (const SurfaceRule rule : {SurfaceRule::area, SurfaceRule::conservative, SurfaceRule::thin})
      for (const MipFilter filter : {MipFilter::coverage, MipFilter::thesis, MipFilter::box}) {
        parameters.surface = rule;
        parameters.mip = filter;
        const std::vector<Hash128> host =
            hashes(kernels::bake_cell(cell.input(), cell_parameters(job, parameters, 0), pool_), job, parameters);
        for (const std::uint64_t bytes : {std::uint64_t(0), few_bytes}) {
          EXPECT_EQ(host,
                    hashes(baker_->bake_cell(cell.input(), cell_parameters(job, parameters, bytes)), job, parameters))
              << job.name << ", rule " << int(rule) << ", filter " << int(filter) << ", bytes " << bytes;
          ++outcome.comparisons;
        }
      }
  }

  ThreadPool pool_{host_limits().cores()};

 protected:
  std::unique_ptr<kernels::CudaBaker> baker_;
  std::string reason_;
};

class DataSets : public testing::TestWithParam<const char*>, protected OnBothBackends {
 protected:
  void SetUp() override {
    find_device();
    if (!baker_) GTEST_SKIP() << reason_;
  }
};

class DeviceSample : public testing::Test, protected OnBothBackends {
 protected:
  void SetUp() override {
    find_device();
    if (!baker_) GTEST_SKIP() << reason_;
  }
};

TEST_P(DataSets, HaveTheSameHashesOnCpuAndGpu) {
  const Path folder = shared_data() / GetParam();
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << folder << " is absent";
  Outcome outcome;
  std::set<Path> files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    const Path extension = entry.path().extension();
    if (entry.is_regular_file() && (extension == ".gltf" || extension == ".glb" || extension == ".json"))
      files.insert(entry.path());
  }
  for (const Path& file : files) {
    SCOPED_TRACE(file.string());
    compare(file, outcome);
  }
  std::cout << outcome.sources << " sources, " << outcome.without_cells << " of them without triangles, "
            << outcome.cells << " cells, " << outcome.comparisons << " comparisons\n";
  // 2026-11-22: if all sources were refused, nothing was compared, and the test passed.
  EXPECT_GT(outcome.comparisons, 0) << folder << " is there, and nothing of its " << files.size()
                                    << " files was compared";
}

TEST_F(DeviceSample, SampleHasTheSameHashesOnCpuAndGpu) {
  const Path folder = Path(testing::TempDir()) / "gigabake_device_sample";
  sample::SampleOptions options;
  options.size_m = 192;
  sample::write_sample(folder, options);
  Outcome outcome;
  compare(folder / "tileset.json", outcome);
  std::filesystem::remove_all(folder);
  EXPECT_GT(outcome.comparisons, 0);
}

/// The sets with content to bake; gltf-validator-cases have none.
INSTANTIATE_TEST_SUITE_P(Shared, DataSets,
                         testing::Values("mars-terrain-3dtiles", "dem-derived-textured-terrain",
                                         "cesium-3dtiles-samples", "cesium-native-tilesets", "cesiumjs-spec-tiles",
                                         "upaxis-tilesets", "detail-models", "gltf-sample-models", "gltf-compressed",
                                         "nasty-meshes", "3dtiles-validator-cases"),
                         [](const auto& test) {
                           std::string name = test.param;
                           std::replace(name.begin(), name.end(), '-', '_');
                           return name;
                         });

}  // namespace
}  // namespace gigabake
