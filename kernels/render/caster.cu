#include <algorithm>
#include <cstring>
#include <utility>

#include "kernels/cuda/device/download_ring.cuh"
#include "kernels/cuda/device/input.cuh"
#include "kernels/cuda/device/memory.cuh"
#include "kernels/cuda/device/stream.cuh"
#include "kernels/cuda/device/upload_ring.cuh"
#include "kernels/light/light_passes.cuh"
#include "kernels/marching/blend_passes.cuh"
#include "kernels/marching/ray_rounds.cuh"
#include "kernels/marching/tile_grid.cuh"
#include "kernels/render/brick_pool.cuh"
#include "kernels/render/caster.h"
#include "kernels/render/device_page_pool.cuh"

namespace gigabake::kernels {
namespace {

/// Max number of requests reported per pass. Rays repeat the remaining requests in the next pass.
constexpr std::uint32_t max_requests = 1u << 20;

__global__ void start_rays(CastScene scene, CastCamera camera, CastTile tile, CastRay* rays) {
  int x, y;
  if (!pixel_of_thread(tile, x, y)) return;
  rays[y * tile.width + x] = start_ray(scene, line_of_sight(scene, camera, tile.x + x, tile.y + y));
}

__global__ void write_pixels(CastScene scene, CastCamera camera, CastTile tile, const CastRay* rays,
                             CastBackground background, Tables tables, CastPixels out) {
  int x, y;
  if (!pixel_of_thread(tile, x, y)) return;
  const std::size_t i = std::size_t(y) * std::size_t(tile.width) + std::size_t(x);
  const CastRay shown = before_polygons(rays[i], camera, tile.x + x, tile.y + y);
  write_pixel(shown, line_of_sight(scene, camera, tile.x + x, tile.y + y), camera.tone, tile, background, tables, i,
              out);
}

__global__ void apply_changes(const NodeChange* changes, std::uint32_t count, NodeWord* nodes,
                              std::uint32_t* parent_bricks) {
  const std::uint32_t i = blockIdx.x * blockDim.x + threadIdx.x;
  if (i >= count) return;
  const NodeChange change = changes[i];
  nodes[change.node] = pack_node(change.value);
  if (is_resident(change.value.children)) parent_bricks[change.value.children] = change.value.brick;
}

/// Lists the requests in no particular order. Each thread reads one word.
__global__ void list_requests(const std::uint32_t* requested, std::uint32_t words, std::uint32_t* list,
                              std::uint32_t* count) {
  const std::uint32_t i = blockIdx.x * blockDim.x + threadIdx.x;
  if (i >= words || requested[i] == 0) return;
  std::uint32_t at = atomicAdd(count, std::uint32_t(__popc(requested[i])));
  for (std::uint32_t left = requested[i]; left != 0 && at < max_requests; left &= left - 1)
    list[at++] = 32 * i + std::uint32_t(lowest_one(left));
}

class CudaCaster final : public Caster {
 public:
  CudaCaster(const CastScene& scene, const PoolSizes& sizes, const PagePoolSize& pages, int device,
             const ThreadPool& pool)
      : device_(device),
        stream_(device),
        heap_(stream_.handle, memory_stats_),
        tables_(heap_),
        cells_(copy(scene.cells)),
        column_key_(copy(scene.column_key)),
        column_first_(copy(scene.column_first)),
        nodes_(copy_of(std::vector<NodeWord>(std::size_t(8) * sizes.tiles, pack_node({})))),
        parent_bricks_(heap_, sizes.tiles),
        uploads_(heap_),
        data_stream_(device, StreamPriority::high),
        data_heap_(data_stream_.handle, memory_stats_),
        data_uploads_(data_heap_),
        pages_(data_heap_, data_uploads_, pool, pages, tables_.view()),
        bricks_(data_heap_, data_uploads_, pool, sizes),
        tile_used_(zeros<std::uint32_t>(sizes.tiles)),
        slot_used_(zeros<std::uint32_t>(sizes.slots)),
        wanted_(zeros<std::uint32_t>(sizes.request_words())),
        request_list_(heap_, std::min<std::size_t>(32 * wanted_.size(), max_requests)),
        count_(heap_, 1),
        unfinished_(heap_, 1),
        downloads_(stream_.handle, pool),
        rounds_(heap_, stream_.handle, device),
        blend_(heap_, stream_.handle),
        light_(heap_, stream_.handle),
        scene_(scene) {
    scene_.cells = {cells_.data(), cells_.size()};
    scene_.column_key = {column_key_.data(), column_key_.size()};
    scene_.column_first = {column_first_.data(), column_first_.size()};
    scene_.nodes = nodes_.data();
    scene_.parent_bricks = parent_bricks_.data();
    bricks_.show_in(scene_);
    scene_.feedback = {tile_used_.data(), slot_used_.data(), wanted_.data()};
    scene_.pass = 0;
    finish("making pools");
    wait_for(data_stream_.handle, "making pools");
  }

  ~CudaCaster() override {
    cudaStreamSynchronize(stream_.handle);  // the streams use each other's arrays
    cudaStreamSynchronize(data_stream_.handle);
  }

  void put_pages(const std::vector<PageUpload>& pages) override {
    use_device();
    pages_.put(pages);
  }

  void put_bricks(const std::vector<BrickPlace>& places, const CastBricks& bricks) override {
    if (places.empty()) return;
    use_device();
    bricks_.put(places, bricks, pages_);
  }

  void move_voxels(const std::vector<VoxelMove>& moves) override {
    use_device();
    bricks_.move(moves);
    wait_for_data();
  }

  void put_nodes(const std::vector<NodeChange>& changes) override {
    if (changes.empty()) return;
    use_device();
    wait_for_data();
    const NodeChange* const sent = uploads_.send(changes);
    apply_changes<<<grid_of(changes.size(), 128), 128, 0, stream_.handle>>>(sent, std::uint32_t(changes.size()),
                                                                            nodes_.data(), parent_bricks_.data());
    check_launch("apply_changes");
  }

  void start(const CastCamera& camera, const CastTile& tile) override {
    use_device();
    camera_ = camera;
    put_polygons();
    tile_ = tile;
    is_lit_ = is_blending_ = false;
    const std::size_t rays = ray_count();
    if (rays_.size() < rays) rays_ = DeviceArray<CastRay>(heap_, rays);
    is_started_ = false;
  }

  std::size_t cast(std::size_t begin, std::size_t end, bool blocking, const StopAsked& stop) override {
    const bool is_whole = begin == 0 && end == ray_count(), starts = is_whole && !is_started_;
    return one_pass(end - begin, blocking, stop, [&](RayPass pass) {
      pass.starts = starts;
      pass.resumes = is_whole && is_started_;
      if (!starts) start_rays_once();
      is_started_ = true;
      rounds_.cast(pass, begin, end);
    });
  }

  void start_blend() override {
    use_device();
    start_rays_once();
    is_blending_ = true;
    blend_.start(pass_of(true));
  }

  std::size_t cast_blend(std::size_t begin, std::size_t end, bool blocking, const StopAsked& stop) override {
    return one_pass(end - begin, blocking, stop, [&](const RayPass& pass) { blend_.cast(rounds_, pass, begin, end); });
  }

  void start_light(const CastLighting& lighting, std::shared_ptr<const SurfaceShader> shader) override {
    use_device();
    blend();
    is_lit_ = true;
    light_.start(lighting, std::move(shader), ray_count());
  }

  std::size_t cast_light(std::size_t begin, std::size_t end, bool blocking, const StopAsked& stop) override {
    return one_pass(end - begin, blocking, stop, [&](const RayPass& pass) { light_.cast(pass, begin, end); });
  }

  void reuse_shadow_samples() override {
    use_device();
    light_.share(tile_);
  }

  std::vector<std::uint32_t> requested() override {
    use_device();
    count_.clear_to_zero();
    const auto words = std::uint32_t(wanted_.size());
    list_requests<<<grid_of(words, 256), 256, 0, stream_.handle>>>(wanted_.data(), words, request_list_.data(),
                                                                   count_.data());
    check_launch("list_wants");
    std::uint32_t count = 0;
    download(&count, count_.data(), 1);
    std::vector<std::uint32_t> list(std::min<std::size_t>(count, request_list_.size()));
    download(list.data(), request_list_.data(), list.size());
    return list;
  }

  std::uint32_t pass() const override { return scene_.pass; }
  const std::vector<std::uint32_t>& tile_timestamps() override { return read_back(tile_used_, host_tile_used_); }
  const std::vector<std::uint32_t>& slot_timestamps() override { return read_back(slot_used_, host_slot_used_); }

  void resolve(const CastBackground& background, const CastPixels& out) override {
    use_device();
    start_rays_once();
    const std::size_t rays = ray_count();
    const CastPixels here{device_array_for(out.srgb, srgb_, 4 * rays), device_array_for(out.linear, linear_, 4 * rays),
                          device_array_for(out.depth, depth_, rays)};
    blend();
    const CastRay* shown = is_lit_ ? light_.lit(rays_.data(), camera_, tile_) : rays_.data();
    write_pixels<<<grid_of_tile(tile_), tile_threads, 0, stream_.handle>>>(scene_, camera_, tile_, shown, background,
                                                                           tables_.view(), here);
    check_launch("write_pixels");
    std::vector<DownloadRing::Part> parts;
    if (out.srgb != nullptr) parts.push_back({out.srgb, here.srgb, 4 * rays});
    if (out.linear != nullptr) parts.push_back({out.linear, here.linear, 4 * rays * sizeof(float)});
    if (out.depth != nullptr) parts.push_back({out.depth, here.depth, rays * sizeof(float)});
    downloads_.bring(parts);
  }

 private:
  std::size_t ray_count() const { return std::size_t(tile_.width) * std::size_t(tile_.height); }

  /// Starts the rays if no pass over the whole tile has started them.
  void start_rays_once() {
    if (is_started_) return;
    is_started_ = true;
    start_rays<<<grid_of_tile(tile_), tile_threads, 0, stream_.handle>>>(scene_, camera_, tile_, rays_.data());
    check_launch("start_rays");
  }

  /// Runs one pass. launch(RayPass) must continue `rays` rays. A pass takes a few milliseconds at most, so `stop` is
  /// called only before it.
  template <class Launch>
  std::size_t one_pass(std::size_t rays, bool blocking, const StopAsked& stop, const Launch& launch) {
    if (stop && stop()) return rays;
    use_device();
    ++scene_.pass;
    wanted_.clear_to_zero();
    unfinished_.clear_to_zero();
    launch(pass_of(blocking));
    unsigned long long unfinished = 0;
    download(&unfinished, unfinished_.data(), 1);
    return std::size_t(unfinished);
  }

  RayPass pass_of(bool blocking) {
    return {scene_, camera_, tile_, rays_.data(), blocking, false, false, unfinished_.data()};
  }

  /// Blends the second rays into the first rays, once.
  void blend() {
    if (is_blending_) blend_.blend(pass_of(true));
    is_blending_ = false;
  }

  /// Copies the camera's polygons from the caller's memory to the device.
  void put_polygons() {
    CastPolygons& polygons = camera_.polygons;
    if (polygons.distance == nullptr) return;
    const std::size_t pixels = std::size_t(camera_.width) * std::size_t(camera_.height);
    polygon_distance_ = copy(Span<const float>{polygons.distance, pixels});
    polygon_rgba_ = copy(Span<const float>{polygons.rgba, 4 * pixels});
    polygons = {polygon_distance_.data(), polygon_rgba_.data()};
  }

  /// Makes rays wait for the bricks that were put or moved so far.
  void wait_for_data() {
    check_cuda(cudaEventRecord(data_sent_.handle, data_stream_.handle), "cudaEventRecord");
    check_cuda(cudaStreamWaitEvent(stream_.handle, data_sent_.handle), "cudaStreamWaitEvent");
  }

  void use_device() { check_cuda(cudaSetDevice(device_), "cudaSetDevice"); }

  void finish(const char* what) { check_cuda(cudaStreamSynchronize(stream_.handle), what); }

  template <class T>
  DeviceArray<std::remove_const_t<T>> copy(const Span<T>& host) {
    DeviceArray<std::remove_const_t<T>> array(heap_, host.size);
    check_cuda(cudaMemcpyAsync(array.data(), host.data, array.bytes(), cudaMemcpyHostToDevice, stream_.handle),
               "cudaMemcpyAsync");
    finish("cudaMemcpyAsync");
    return array;
  }

  template <class T>
  DeviceArray<T> copy_of(const std::vector<T>& host) {
    return copy(Span<const T>{host.data(), host.size()});
  }

  /// Returns device memory for `size` values that are requested at `host`; null if none are requested.
  template <class T>
  T* device_array_for(const T* host, DeviceArray<T>& array, std::size_t size) {
    if (host == nullptr) return nullptr;
    if (array.size() < size) array = DeviceArray<T>(heap_, size);
    return array.data();
  }

  template <class T>
  DeviceArray<T> zeros(std::size_t size) {
    DeviceArray<T> array(heap_, size);
    array.clear_to_zero();
    return array;
  }

  /// Copies an array to the host and waits until the copy is complete.
  template <class T>
  void download(T* host, const T* device, std::size_t count) {
    const DownloadRing::Part part{host, device, count * sizeof(T)};
    downloads_.bring({&part, 1});
  }

  const std::vector<std::uint32_t>& read_back(const DeviceArray<std::uint32_t>& feedback,
                                              std::vector<std::uint32_t>& host) {
    use_device();
    host.resize(feedback.size());
    download(host.data(), feedback.data(), host.size());
    return host;
  }

  int device_;
  Stream stream_;
  DeviceMemoryStats memory_stats_;
  DeviceHeap heap_;
  DeviceTables tables_;
  DeviceArray<CastCell> cells_;
  DeviceArray<std::uint64_t> column_key_;
  DeviceArray<std::uint32_t> column_first_;
  DeviceArray<NodeWord> nodes_;
  DeviceArray<std::uint32_t> parent_bricks_;
  UploadRing uploads_;
  /// Pages and bricks have a separate stream, so that another thread uploads them while rays are cast.
  Stream data_stream_;
  DeviceHeap data_heap_;
  UploadRing data_uploads_;
  Event data_sent_;
  DevicePagePool pages_;
  BrickPool bricks_;
  DeviceArray<std::uint32_t> tile_used_, slot_used_, wanted_, request_list_, count_;
  DeviceArray<unsigned long long> unfinished_;
  DownloadRing downloads_;
  RayRounds rounds_;
  BlendPasses blend_;
  LightPasses light_;
  bool is_started_ = false, is_lit_ = false, is_blending_ = false;
  CastScene scene_;
  CastCamera camera_;
  CastTile tile_;
  DeviceArray<CastRay> rays_;
  DeviceArray<float> linear_, depth_, polygon_distance_, polygon_rgba_;
  DeviceArray<std::uint8_t> srgb_;
  std::vector<std::uint32_t> host_tile_used_, host_slot_used_;
};

}  // namespace

std::unique_ptr<Caster> make_cuda_caster(const CastScene& scene, const PoolSizes& sizes, const PagePoolSize& pages,
                                         int device, const ThreadPool& policy) {
  return std::make_unique<CudaCaster>(scene, sizes, pages, device, policy);
}

}  // namespace gigabake::kernels
