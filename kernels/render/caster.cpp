#include "kernels/render/caster.h"

#include <algorithm>
#include <atomic>
#include <cstring>
#include <utility>

#include "core/base/thread_pool.h"
#include "kernels/body/tables.h"
#include "kernels/light/shadow_reuse.h"
#include "kernels/marching/level_blend.h"

namespace gigabake::kernels {
namespace {

constexpr int block_edge = 8;  ///< pixels; neighbouring pixels use the same bricks
constexpr std::size_t blocks_per_range = 4, copies_per_range = 64;

class CpuCaster final : public Caster {
 public:
  CpuCaster(const CastScene& scene, const PoolSizes& sizes, const PagePoolSize& pages, const ThreadPool& pool)
      : pool_(pool),
        scene_(scene),
        nodes_(std::size_t(8) * sizes.tiles, pack_node({})),
        parent_bricks_(sizes.tiles),
        heads_(new CastHead[sizes.slots]),
        voxels_(new PackedVoxel[sizes.voxels]),
        pages_(pages),
        shading_(pages.shading),
        tile_used_(sizes.tiles),
        slot_used_(sizes.slots),
        wanted_(sizes.request_words()) {
    scene_.nodes = nodes_.data();
    scene_.parent_bricks = parent_bricks_.data();
    scene_.heads = heads_.get();
    scene_.voxels = voxels_.get();
    scene_.feedback = {tile_used_.data(), slot_used_.data(), wanted_.data()};
    scene_.pass = 0;
  }

  void put_pages(const std::vector<PageUpload>& pages) override { pages_.put(pages, pool_); }

  void put_bricks(const std::vector<BrickPlace>& places, const CastBricks& bricks) override {
    // The first write to a part of the pool also makes the system allocate its memory, so all threads write.
    pool_.parallel_for(places.size(), copies_per_range, [&](std::size_t begin, std::size_t end, int) {
      for (std::size_t i = begin; i < end; ++i) {
        CastHead& head = heads_[places[i].slot];
        head = bricks[i]->head;
        head.first = places[i].first;
        std::copy(bricks[i]->parts.begin(), bricks[i]->parts.end(), voxels_.get() + places[i].first);
        copy_pooled_runs(shading_, pages_.voxels(), *bricks[i], voxels_.get() + places[i].first);
      }
    });
  }

  void move_voxels(const std::vector<VoxelMove>& moves) override {
    for (const VoxelMove& move : moves) {
      std::memmove(voxels_.get() + move.to, voxels_.get() + move.from, sizeof(PackedVoxel) * move.count);
      heads_[move.slot].first = move.to;
    }
  }

  void put_nodes(const std::vector<NodeChange>& changes) override {
    for (const NodeChange& change : changes) {
      nodes_[change.node] = pack_node(change.value);
      if (is_resident(change.value.children)) parent_bricks_[change.value.children] = change.value.brick;
      nodes_end_ = std::max<std::size_t>(nodes_end_, change.node + 1);
    }
  }

  void start(const CastCamera& camera, const CastTile& tile) override {
    camera_ = camera;
    tile_ = tile;
    lights_.clear();
    is_blending_ = false;
    rays_.resize(std::size_t(tile.width) * std::size_t(tile.height));
    begin_phase();
    for_each_ray([&](std::size_t i) { rays_[i] = start_ray(scene_, line_of(i)); });
  }

  std::size_t cast(std::size_t begin, std::size_t end, bool blocking, const StopAsked& stop) override {
    return one_pass(begin, end, stop, [&](std::size_t i) {
      CastRay& ray = rays_[i];
      if (ray.lod >= 0) cast_primary(camera_, line_of(i), blocking, ray);
      return ray.lod < 0;
    });
  }

  void start_blend() override {
    coarser_.resize(rays_.size());
    is_blending_ = true;
    begin_phase();
    for_each_ray([&](std::size_t i) { coarser_[i] = start_coarser(scene_, line_of(i), coarser_line(i), rays_[i]); });
  }

  std::size_t cast_blend(std::size_t begin, std::size_t end, bool blocking, const StopAsked& stop) override {
    const CastCamera coarser = coarser_camera(camera_);
    return one_pass(begin, end, stop, [&](std::size_t i) {
      CastRay& second = coarser_[i];
      if (second.lod >= 0) cast_primary(coarser, coarser_line(i), blocking, second);
      return second.lod < 0;
    });
  }

  void start_light(const CastLighting& lighting, std::shared_ptr<const SurfaceShader> shader) override {
    blend();
    lighting_ = lighting;
    shader_ = shader ? std::move(shader) : lit_shader({lighting.light, lighting.part});
    lights_.assign(rays_.size(), PixelLight());
    begin_phase();
  }

  std::size_t cast_light(std::size_t begin, std::size_t end, bool blocking, const StopAsked& stop) override {
    return one_pass(begin, end, stop, [&](std::size_t i) {
      PixelLight& light = lights_[i];
      if (light.done != PixelLight::all)
        light_pixel(scene_, camera_, lighting_, line_of(i), rays_[i], pixel_x(i), pixel_y(i), blocking, light);
      return light.done == PixelLight::all;
    });
  }

  void reuse_shadow_samples() override {
    begin_phase();
    for_each_ray([&](std::size_t i) {
      const int x = int(i % std::size_t(tile_.width)), y = int(i / std::size_t(tile_.width));
      kernels::reuse_shadow_samples({lights_.data(), tile_}, lighting_, x, y, lights_[i]);
    });
  }

  std::vector<std::uint32_t> requested() override {
    std::vector<std::uint32_t> found;
    for (std::size_t i = 0; i < request_words(); ++i)
      for (std::uint32_t left = wanted_[i]; left != 0; left &= left - 1)
        found.push_back(std::uint32_t(32 * i) + std::uint32_t(kernels::lowest_one(left)));
    return found;
  }

  std::uint32_t pass() const override { return scene_.pass; }
  const std::vector<std::uint32_t>& tile_timestamps() override { return tile_used_; }
  const std::vector<std::uint32_t>& slot_timestamps() override { return slot_used_; }

  void resolve(const CastBackground& background, const CastPixels& out) override {
    const Tables tables = TableStore::host().view();
    blend();
    shade();
    for_each_ray([&](std::size_t i) {
      const CastRay& lit = lights_.empty() ? rays_[i] : lit_[i];
      const CastRay shown = before_polygons(lit, camera_, pixel_x(i), pixel_y(i));
      write_pixel(shown, line_of(i), camera_.tone, tile_, background, tables, i, out);
    });
  }

 private:
  int pixel_x(std::size_t ray) const { return tile_.x + int(ray % std::size_t(tile_.width)); }
  int pixel_y(std::size_t ray) const { return tile_.y + int(ray / std::size_t(tile_.width)); }
  CastLine line_of(std::size_t ray) const { return line_of_sight(scene_, camera_, pixel_x(ray), pixel_y(ray)); }
  CastLine coarser_line(std::size_t ray) const {
    return line_of_sight(scene_, coarser_camera(camera_), pixel_x(ray), pixel_y(ray));
  }

  void cast_primary(const CastCamera& camera, const CastLine& line, bool blocking, CastRay& ray) const {
    if (scene_.is_lit)
      cast_ray<RayType::lit>(scene_, camera, line, blocking, true, ray);
    else
      cast_ray(scene_, camera, line, blocking, true, ray);
  }

  /// Blends the second rays into the first rays, once.
  void blend() {
    if (!is_blending_) return;
    is_blending_ = false;
    for_each_ray([&](std::size_t i) { rays_[i] = blended(scene_, line_of(i), rays_[i], coarser_[i]); });
  }

  /// Returns the number of words of `wanted_` that rays can change: the words of all nodes that were ever written, and
  /// of the roots.
  std::size_t request_words() const { return (2 * std::max(nodes_end_, scene_.cells.size) + 31) / 32; }

  void shade() {
    if (lights_.empty()) return;
    lit_.resize(rays_.size());
    shader_->on_host({rays_.data(), lights_.data(), tile_, lighting_, camera_.eye}, lit_.data(), pool_);
  }

  /// A square of block_edge × block_edge rays. Blocks at the upper borders of the tile may be smaller.
  struct Block {
    std::size_t number = 0;
    int x = 0, y = 0, x_end = 0, y_end = 0;  ///< pixels of the tile

    std::size_t rays() const { return std::size_t(x_end - x) * std::size_t(y_end - y); }
  };

  std::size_t blocks_across() const { return std::size_t(tile_.width + block_edge - 1) / block_edge; }
  std::size_t block_rows() const { return std::size_t(tile_.height + block_edge - 1) / block_edge; }
  Block block_at(std::size_t number) const {
    const int x = int(number % blocks_across()) * block_edge, y = int(number / blocks_across()) * block_edge;
    return {number, x, y, std::min(x + block_edge, tile_.width), std::min(y + block_edge, tile_.height)};
  }

  /// Begins a phase, in which no ray is finished yet.
  void begin_phase() { is_finished_.assign(blocks_across() * block_rows(), 0); }

  /// Runs one pass. resume(i) continues ray i and returns true if the ray is finished in this phase. Returns the number
  /// of unfinished rays. Finished blocks are skipped, because reading their rays would take longer than most passes.
  template <class GoOn>
  std::size_t one_pass(std::size_t begin, std::size_t end, const StopAsked& stop, const GoOn& resume) {
    ++scene_.pass;
    std::fill_n(wanted_.begin(), request_words(), 0);
    std::atomic<std::size_t> unfinished{0};
    const bool whole = for_each_block(begin, end, stop, [&](const Block& block) {
      if (is_finished_[block.number] != 0) return;
      // Threads would wait for each other if they counted each ray in a common variable.
      std::size_t finished = 0, rays = 0;
      for_each_ray_of(block, begin, end, [&](std::size_t i) {
        finished += resume(i) ? 1 : 0;
        ++rays;
      });
      if (finished == block.rays()) is_finished_[block.number] = 1;
      if (finished != rays) unfinished.fetch_add(rays - finished, std::memory_order_relaxed);
    });
    return whole ? unfinished.load() : std::max<std::size_t>(unfinished, 1);
  }

  /// Calls body(i) for each ray i of the tile.
  template <class Body>
  void for_each_ray(const Body& body) {
    for_each_block(0, rays_.size(), {}, [&](const Block& block) { for_each_ray_of(block, 0, rays_.size(), body); });
  }

  /// Calls body(i) for each ray i of the block in [begin, end).
  template <class Body>
  void for_each_ray_of(const Block& block, std::size_t begin, std::size_t end, const Body& body) const {
    for (int y = block.y; y < block.y_end; ++y)
      for (int x = block.x; x < block.x_end; ++x) {
        const std::size_t i = std::size_t(y) * std::size_t(tile_.width) + std::size_t(x);
        if (i >= begin && i < end) body(i);
      }
  }

  /// Calls body(block) for the blocks in the rows of rays [begin, end). Returns false if `stop` ended the calls before
  /// the last block.
  template <class Body>
  bool for_each_block(std::size_t begin, std::size_t end, const StopAsked& stop, const Body& body) {
    std::atomic<bool> stopped{false};
    const std::size_t rays_per_row = std::size_t(tile_.width) * block_edge;  // a row of blocks
    const std::size_t top = begin / rays_per_row, bottom = (end + rays_per_row - 1) / rays_per_row;
    const std::size_t first_block = blocks_across() * top;
    pool_.parallel_for(blocks_across() * (bottom - top), blocks_per_range, [&](std::size_t from, std::size_t to, int) {
      if (stop && !stopped && stop()) stopped = true;
      for (std::size_t b = first_block + from; b < first_block + to && !stopped; ++b) body(block_at(b));
    });
    return !stopped;
  }

  const ThreadPool& pool_;
  CastScene scene_;
  std::vector<NodeWord> nodes_;
  std::vector<std::uint32_t> parent_bricks_;
  std::size_t nodes_end_ = 0;  ///< nodes from this index were never written
  // The arrays are not initialised, because untouched pages cost no memory.
  std::unique_ptr<CastHead[]> heads_;
  std::unique_ptr<PackedVoxel[]> voxels_;
  PagePool pages_;
  StoredVoxelShading shading_;
  std::vector<std::uint32_t> tile_used_, slot_used_, wanted_;
  CastCamera camera_;
  CastTile tile_;
  std::vector<CastRay> rays_, coarser_, lit_;
  std::vector<std::uint8_t> is_finished_;  ///< by block: all its rays are finished in the current phase
  bool is_blending_ = false;
  CastLighting lighting_;
  std::shared_ptr<const SurfaceShader> shader_;
  std::vector<PixelLight> lights_;  ///< of the tile's pixels; empty: no lighting
};

}  // namespace

std::uint64_t PoolSizes::bytes() const {
  const std::uint64_t tile = 8 * sizeof(NodeWord) + 2 * sizeof(std::uint32_t);
  const std::uint64_t slot = sizeof(CastHead) + sizeof(std::uint32_t);
  return tiles * tile + request_words() * sizeof(std::uint32_t) + slots * slot +
         voxels * std::uint64_t(sizeof(PackedVoxel));
}

std::unique_ptr<Caster> make_cpu_caster(const CastScene& scene, const PoolSizes& sizes, const PagePoolSize& pages,
                                        const ThreadPool& pool) {
  return std::make_unique<CpuCaster>(scene, sizes, pages, pool);
}

}  // namespace gigabake::kernels
