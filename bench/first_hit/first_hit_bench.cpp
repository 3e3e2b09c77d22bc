#include "bench/first_hit/first_hit_bench.h"

#include <algorithm>
#include <cstring>
#include <functional>
#include <memory>

#include "bench/accuracy/reference_voxels.h"
#include "bench/bench_scene.h"
#include "bench/first_hit/first_hit_reference.h"
#include "bench/first_hit/first_hit_views.h"
#include "query/first_hit/first_hit_device.h"
#include "query/first_hit_scene.h"

namespace gigabake::bench {
namespace {

constexpr unsigned seed = 20261121;
constexpr int max_cpu_repeats = 3;
constexpr double promised_rounding = 0x1p-20;  ///< fraction of the tree's edge: query/first_hit/first_hit.h

struct Spread {
  double best, median;
};

/// Returns the minimum and the median time of several runs. once() performs a run and returns its duration in seconds.
Spread repeat(int repeats, const std::function<double()>& once) {
  once();
  std::vector<double> s;
  for (int i = 0; i < repeats; ++i) s.push_back(once());
  std::sort(s.begin(), s.end());
  return {s.front(), s[s.size() / 2]};
}

/// Times a view with and without voxel attributes. run(true) casts the view with attributes, and run(false) without.
/// `run` returns the seconds that the cast took.
FirstHitTimes time_view(const char* backend, int repeats, const std::function<double(bool)>& run) {
  const Spread attributes = repeat(repeats, [&] { return run(true); }),
               plain = repeat(repeats, [&] { return run(false); });
  return {backend, plain.best, plain.median, attributes.best, attributes.median};
}

class Bench {
 public:
  explicit Bench(const FirstHitBenchRequest& request)
      : request_(request), description_(read_scene(request.scene)), pool_(request.threads) {
    const auto start = Clock::now();
    scene_ = build_first_hit_scene(description_, request.scene, request.lod);
    build_s_ = seconds_since(start);
    if (request.device) cuda_ = std::make_unique<kernels::CudaFirstHits>(*request.device, scene_.view);
    if (request.reference_rays > 0)
      reference_ = std::make_unique<ReferenceVoxels>(description_, request.scene, request.lod);
  }

  FirstHitBench run() {
    FirstHitBench b{request_.width,
                    request_.height,
                    request_.lod,
                    scene_.voxels,
                    scene_.nodes.size(),
                    scene_.tree_bytes(),
                    scene_.bytes(),
                    build_s_,
                    {}};
    if (scene_.nodes.empty()) return b;
    for (const FirstHitBenchView& view : first_hit_views(scene_.view.tree, request_.width, request_.height))
      b.rows.push_back(run(view));
    return b;
  }

 private:
  FirstHitRow run(const FirstHitBenchView& view) {
    const std::size_t count = std::size_t(request_.width) * std::size_t(request_.height);
    rays_.clear();
    if (!view.camera) rays_ = random_rays(scene_.view.tree, count, seed);
    FirstHitRow row;
    row.view = view.name;
    row.rays = count;
    if (view.camera) row.beam_tile = kernels::plan_beams(scene_.view, *view.camera).tile;
    std::vector<kernels::FirstHit> hits(count);
    if (request_.cpu) row.times.push_back(time_cpu(view, hits));
    if (cuda_) {
      row.times.push_back(time_cuda(view));
      const std::vector<kernels::FirstHit> device_hits = cuda_->hits();
      if (!request_.cpu) cast_on_cpu(view, {{hits.data(), count}, {}});
      for (std::size_t i = 0; i < count; ++i) row.differ += std::memcmp(&hits[i], &device_hits[i], sizeof hits[i]) != 0;
    }
    for (const kernels::FirstHit& hit : hits) row.hits += hit.attributes_index != kernels::no_attributes;
    if (reference_) check(view, hits, row);
    return row;
  }

  void cast_on_cpu(const FirstHitBenchView& view, const kernels::FirstHitResult& result) const {
    if (view.camera)
      kernels::cast_first_hits(scene_.view, *view.camera, result, pool_);
    else
      kernels::cast_first_hits(scene_.view, {rays_.data(), rays_.size()}, result, pool_);
  }

  FirstHitTimes time_cpu(const FirstHitBenchView& view, std::vector<kernels::FirstHit>& hits) const {
    std::vector<kernels::VoxelAttributes> attributes(hits.size());
    return time_view("cpu", std::min(request_.repeats, max_cpu_repeats), [&](bool with_attributes) {
      const auto start = Clock::now();
      cast_on_cpu(view, {{hits.data(), hits.size()}, {attributes.data(), with_attributes ? attributes.size() : 0}});
      return seconds_since(start);
    });
  }

  FirstHitTimes time_cuda(const FirstHitBenchView& view) {
    if (!view.camera) cuda_->upload({rays_.data(), rays_.size()});
    return time_view("cuda", request_.repeats, [&](bool with_attributes) {
      return view.camera ? cuda_->cast(*view.camera, with_attributes) : cuda_->cast(with_attributes);
    });
  }

  void check(const FirstHitBenchView& view, const std::vector<kernels::FirstHit>& hits, FirstHitRow& row) const {
    const kernels::FirstHitTree& tree = scene_.view.tree;
    const std::size_t step = std::max<std::size_t>(1, hits.size() / request_.reference_rays);
    const Vec3i64 shift = (scene_.lattice_min - reference_->origin()) / (std::int64_t(1) << request_.lod);
    for (std::size_t i = 0; i < hits.size(); i += step, ++row.reference_rays) {
      const auto width = std::size_t(request_.width);
      const kernels::FirstHitRay ray =
          view.camera ? kernels::camera_ray(*view.camera, float(i % width) + 0.5f, float(i / width) + 0.5f) : rays_[i];
      const Agreement agreement = compare(tree, ray, hits[i], promised_rounding * double(1 << tree.bits),
                                          [&](const Vec3i64& v) { return reference_->exists(v + shift); });
      row.within_rounding += agreement == Agreement::within_rounding;
      row.wrong += agreement == Agreement::wrong;
    }
  }

  FirstHitBenchRequest request_;
  SceneDescription description_;
  ThreadPool pool_;
  FirstHitScene scene_;
  double build_s_ = 0;
  std::unique_ptr<kernels::CudaFirstHits> cuda_;
  std::unique_ptr<ReferenceVoxels> reference_;
  std::vector<kernels::FirstHitRay> rays_;
};

}  // namespace

std::uint64_t FirstHitBench::hits() const {
  std::uint64_t sum = 0;
  for (const FirstHitRow& row : rows) sum += row.hits;
  return sum;
}

bool FirstHitBench::failed() const {
  return hits() == 0 ||
         std::any_of(rows.begin(), rows.end(), [](const FirstHitRow& r) { return r.differ != 0 || r.wrong != 0; });
}

FirstHitBench bench_first_hits(const FirstHitBenchRequest& request) { return Bench(request).run(); }

}  // namespace gigabake::bench
