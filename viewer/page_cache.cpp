#include "viewer/page_cache.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "format/error.h"

namespace gigabake {

PageCache::PageCache(const SceneDescription& scene, std::filesystem::path scene_path, CellReader reader,
                     const Options& options, const kernels::CpuPolicy& policy)
    : scene_path_(std::move(scene_path)),
      reader_(std::move(reader)),
      shading_(options.light, scene),
      memory_bytes_(options.memory_bytes),
      policy_(policy),
      layout_(lay_out_cells(scene, scene_path_)),
      page_used_(layout_.cells.size() * (kernels::max_cast_lods + 1)) {
  layout_.scene.page_used = page_used_.data();
  for (const SceneCell& cell : scene.cells) files_.push_back(cell.file);
}

std::filesystem::path PageCache::shard_of(std::uint32_t page) const {
  return scene_path_.parent_path() / files_[layout_.scene_cell[kernels::cell_of_page(page)]];
}

PageCache::Resident PageCache::read(std::uint32_t page) const {
  const std::uint32_t cell = kernels::cell_of_page(page);
  const int lod = kernels::lod_of_page(page);
  Resident resident;
  try {
    if (lod < 0) {
      resident.nodes = make_node_page(reader_.nodes(layout_.scene_cell[cell]), layout_.scene.lods, shading_);
      resident.bytes = resident.nodes.bytes();
    } else {
      const NodePage& nodes = residents_.at(kernels::node_page(cell)).nodes;
      resident.level = make_level_page(reader_.level(layout_.scene_cell[cell], lod), lod,
                                       nodes.bricks[std::size_t(lod)], shading_, policy_);
      resident.bytes = resident.level.bytes();
    }
  } catch (const std::invalid_argument& e) {
    throw InputError(shard_of(page), lod < 0 ? "nodes" : "lod_" + std::to_string(lod),
                     std::string(e.what()) + "; bake the cell again");
  }
  return resident;
}

void PageCache::enter(std::uint32_t page, Resident resident) {
  const Resident& r = residents_[page] = std::move(resident);
  kernels::CastCell& cell = layout_.cells[kernels::cell_of_page(page)];
  const int lod = kernels::lod_of_page(page);
  if (lod < 0) {
    cell.nodes = r.nodes.nodes.data();
    cell.constants = r.nodes.constants.data();
  } else {
    cell.level[lod] = {r.level.bricks.data(), r.level.voxels.data()};
  }
  page_used_[page] = layout_.scene.pass;
  bytes_ += r.bytes;
  ++counts_.loads;
  counts_.peak_bytes = std::max(counts_.peak_bytes, bytes_);
}

void PageCache::evict(std::uint32_t page) {
  const auto found = residents_.find(page);
  kernels::CastCell& cell = layout_.cells[kernels::cell_of_page(page)];
  const int lod = kernels::lod_of_page(page);
  if (lod < 0) {
    cell.nodes = nullptr;
    cell.constants = nullptr;
  } else {
    cell.level[lod] = {};
  }
  bytes_ -= found->second.bytes;
  residents_.erase(found);
}

void PageCache::make_room() {
  if (bytes_ <= memory_bytes_) return;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> unused;  // pass, page
  for (const auto& [page, resident] : residents_)
    if (page_used_[page] != layout_.scene.pass) unused.emplace_back(page_used_[page], page);
  std::sort(unused.begin(), unused.end());
  for (const auto& [pass, page] : unused) {
    if (bytes_ <= memory_bytes_) return;
    evict(page);
  }
}

void PageCache::load(std::vector<std::uint32_t> missing) {
  std::sort(missing.begin(), missing.end());
  missing.erase(std::unique(missing.begin(), missing.end()), missing.end());
  bool first = true;
  for (const std::uint32_t page : missing) {
    if (page == kernels::no_page || (!first && bytes_ >= memory_bytes_)) return;
    enter(page, read(page));
    make_room();
    first = false;
  }
}

}  // namespace gigabake
