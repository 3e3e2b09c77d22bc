#include "bench/kernel_bench.h"

#include <algorithm>
#include <functional>
#include <set>

#include "core/base/error.h"
#include "format/shard/levels/content_hash.h"
#include "kernels/cuda/baker.h"
#include "worker/pipeline/cell_loader.h"
#include "worker/pipeline/cell_parameters.h"
#include "worker/pipeline/shard_from_volume.h"

namespace gigabake::bench {
namespace {

CellJob max_cell(const SceneSources& sources, const BenchScene& scene) {
  const std::vector<CellJob> jobs = plan_scene(sources, scene).jobs;
  return *std::max_element(jobs.begin(), jobs.end(),
                           [](const CellJob& a, const CellJob& b) { return a.triangles < b.triangles; });
}

std::uint64_t bytes_of(const kernels::CellInput& input) {
  std::uint64_t bytes = 0;
  std::set<const void*> seen;
  const auto add = [&](const void* data, std::uint64_t size) {
    if (seen.insert(data).second) bytes += size;
  };
  for (std::size_t i = 0; i < input.parts.size; ++i) {
    const kernels::PartView& p = input.parts[i];
    add(p.position.data, p.position.size * 4);
    add(p.index.data, p.index.size * 4);
    add(p.uv.data, p.uv.size * 4);
    add(p.rgba.data, p.rgba.size * 2);
    add(p.normal.data, p.normal.size * sizeof(VertexNormal));
    add(p.normal_uv.data, p.normal_uv.size * 4);
    add(p.tangent.data, p.tangent.size * sizeof(VertexTangent));
  }
  for (std::size_t i = 0; i < input.textures.size; ++i) {
    const kernels::TextureView& t = input.textures[i];
    add(t.base, std::uint64_t(t.width) * std::uint64_t(t.height) * 20 / 3);  // the image, and a third of 8-byte texels
  }
  return bytes;
}

/// Counts the bytes of the packed output: 4 + 64 + 4 per brick, 4 + 2 per voxel, and 14 per node. Directional coverage
/// adds 3 bytes per voxel.
void count_output(const kernels::CellVolume& volume, KernelBench& out) {
  for (const kernels::Level& level : volume.levels) {
    out.bricks += level.key.size();
    out.voxels += level.rgba.size() / 4;
    out.output_bytes +=
        72 * level.key.size() + level.rgba.size() + level.normal.size() + level.directional_coverage.size();
  }
  if (!volume.levels.empty()) out.voxels_lod0 = volume.levels[0].rgba.size() / 4;
  out.output_bytes += 14 * volume.nodes.key.size();
}

std::string hash_of(kernels::CellVolume volume, const CellJob& job) {
  ShardHeader header;
  header.lattice_min = job.lattice_min;
  header.cell_voxels = job.cell_voxels;
  header.has_normals = !volume.levels.empty() && !volume.levels[0].normal.empty();
  header.has_directional_coverage = volume.levels.size() > 1 && !volume.levels[1].directional_coverage.empty();
  if (volume.levels.empty()) return "empty";
  Hash128 all;
  for (const Hash128& lod : content_hash(shard_from_volume(std::move(volume), header))) all += lod;
  return all.hex();
}

/// Runs `once` for warm-up and then `repeats` times; keeps the run with the fastest kernels.
void repeat(int repeats, const std::function<double(kernels::CellStats&)>& once, BackendTimes& times) {
  kernels::CellStats stats;
  once(stats);
  for (int i = 0; i < repeats; ++i) {
    const double s = once(stats);
    if (i != 0 && s >= times.total_s) continue;
    times.total_s = s;
    times.stats = stats;
  }
}

kernels::CellVolume time_cpu(const KernelBenchRequest& request, const kernels::CellInput& input,
                             const kernels::CellParameters& parameters, BackendTimes& times) {
  const ThreadPool pool(request.scene.threads);
  kernels::CellVolume volume;
  times.backend = "cpu";
  repeat(
      request.repeats,
      [&](kernels::CellStats& stats) {
        const auto start = Clock::now();
        volume = kernels::bake_cell(input, parameters, pool);
        stats = volume.stats;
        return seconds_since(start);
      },
      times);
  return volume;
}

kernels::CellVolume time_cuda(const KernelBenchRequest& request, int device, const kernels::CellInput& input,
                              const kernels::CellParameters& parameters, BackendTimes& times) {
  kernels::CudaBaker baker(device, request.scene.memory_bytes / 4);
  times.backend = "cuda";
  baker.bake_cell(input, parameters);
  const auto upload = Clock::now();
  const std::shared_ptr<const kernels::CudaInput> uploaded = baker.upload(input);
  times.transfer_s = seconds_since(upload);
  std::unique_ptr<kernels::CudaVolume> baked;
  repeat(
      request.repeats,
      [&](kernels::CellStats& stats) {
        baked.reset();
        const auto start = Clock::now();
        baked = baker.bake(*uploaded, parameters);
        const double seconds = seconds_since(start);
        stats = baked->stats();
        return seconds;
      },
      times);
  const auto download = Clock::now();
  kernels::CellVolume volume = baker.download(std::move(baked));
  times.transfer_s += seconds_since(download);
  times.stats.hash_s = volume.stats.hash_s;
  return volume;
}

}  // namespace

KernelBench bench_kernels(const KernelBenchRequest& request) {
  KernelBench out;
  const SceneSources sources = open_sources(request.scene.source, request.scene.source_options, request.scene.progress);
  const CellJob job = max_cell(sources, request.scene);
  CellLoader loader(sources, request.scene.parameters, ~std::uint64_t(0), request.scene.threads);
  const LoadedCell cell = loader.load(job);
  const kernels::CellInput input = cell.input();
  const kernels::CellParameters parameters = cell_parameters(job, request.scene.parameters, request.scene.memory_bytes);
  out.cell = job.name;
  out.input_bytes = bytes_of(input);
  const auto add = [&](kernels::CellVolume volume, BackendTimes times) {
    if (out.times.empty()) count_output(volume, out);
    if (out.voxels == 0)
      throw InputError(request.scene.source, "",
                       "its largest cell has no voxels, so nothing was measured; expected a surface that is visible at "
                       "this voxel size");
    times.content_hash = hash_of(std::move(volume), job);
    out.differ |= !out.times.empty() && out.times[0].content_hash != times.content_hash;
    out.times.push_back(std::move(times));
  };
  if (request.cpu) {
    BackendTimes times;
    kernels::CellVolume volume = time_cpu(request, input, parameters, times);
    add(std::move(volume), std::move(times));
  }
  if (request.cuda) {
    const kernels::CudaDevices devices = kernels::cuda_devices();
    if (devices.usable.empty()) throw UsageError("--backend cuda: " + devices.reason);
    out.copy_bytes_per_s = kernels::device_copy_rate(devices.usable[0]);
    BackendTimes times;
    kernels::CellVolume volume = time_cuda(request, devices.usable[0], input, parameters, times);
    add(std::move(volume), std::move(times));
  }
  return out;
}

}  // namespace gigabake::bench
