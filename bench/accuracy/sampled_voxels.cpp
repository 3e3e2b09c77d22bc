#include "bench/accuracy/sampled_voxels.h"

#include <algorithm>

#include "bench/schedule_model.h"
#include "format/scene/scene_level.h"
#include "format/shard/levels/brick_walk.h"

namespace gigabake::bench {
namespace {

/// Selects one voxel at random from each run of consecutive voxels.
class RunSampler {
 public:
  RunSampler(std::uint64_t run, std::uint64_t seed) : run_(run), seed_(seed) {}

  bool takes_next() {
    const std::uint64_t place = count_ % run_;
    if (place == 0) chosen_ = std::uint64_t(uniform(seed_, count_ / run_) * double(run_));
    ++count_;
    return place == chosen_;
  }

 private:
  std::uint64_t run_, seed_, count_ = 0, chosen_ = 0;
};

}  // namespace

std::vector<SampledVoxel> sample_voxels(const SceneDescription& scene, const std::filesystem::path& scene_path,
                                        std::uint64_t maximum, std::uint64_t seed) {
  const PagedScene paged(scene_path);
  const std::uint64_t voxels = described_voxels(paged, 0);
  RunSampler choice(std::max<std::uint64_t>(1, (voxels + maximum - 1) / maximum), seed);
  std::vector<SampledVoxel> sampled;
  for (const SceneCell& cell : scene.cells) {
    const ReadLevel read = read_level(paged, cell, 0);
    for_each_voxel_of_level(
        read.nodes, read.level, 0,
        [&](std::uint32_t x, std::uint32_t y, std::uint32_t z, const std::uint8_t* rgba, const std::int8_t* normal) {
          if (!choice.takes_next()) return;
          sampled.push_back(
              {cell.lattice_min + Vec3i64{x, y, z}, {rgba[0], rgba[1], rgba[2], rgba[3]}, {normal[0], normal[1]}});
        });
  }
  return sampled;
}

}  // namespace gigabake::bench
