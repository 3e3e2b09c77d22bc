#include "format/scene/xml/page_write.h"

#include <algorithm>
#include <fmt/format.h>
#include <map>
#include <pugixml.hpp>
#include <string>
#include <unordered_set>

#include "core/base/error.h"
#include "format/scene/paged_scene.h"
#include "format/scene/xml/element_text.h"
#include "format/system/host_limits.h"
#include "format/system/publish.h"
#include "format/system/read_file.h"

namespace gigabake {
namespace {

namespace fs = std::filesystem;

constexpr const char* page_folder = "pages";
/// Edge of the largest blocks in lod-0 voxels. Eight such blocks cover the whole lattice.
constexpr std::int64_t max_block_edge = std::int64_t(1) << 52;

/// The content of one block: items [begin, end) of `cells` or of `pages`, and overviews.
struct Block {
  LatticeBlock block;
  std::size_t begin, end;
  std::vector<const SceneCell*> overviews = {};
};

/// Sorts `items` by z, y, x of their block, keeps the order of items within a block, and returns the blocks.
template <class Item, class Place>
std::vector<Block> blocks_of(std::vector<Item>& items, std::int64_t edge, const Place& place) {
  const auto block_of = [&](const Item& item) { return block_around(place(item), edge); };
  std::stable_sort(items.begin(), items.end(),
                   [&](const Item& a, const Item& b) { return block_of(a).min.zyx() < block_of(b).min.zyx(); });
  std::vector<Block> blocks;
  for (std::size_t i = 0; i < items.size(); ++i) {
    const LatticeBlock block = block_of(items[i]);
    if (blocks.empty() || blocks.back().block != block) blocks.push_back({block, i, i});
    blocks.back().end = i + 1;
  }
  return blocks;
}

bool holds(const fs::path& file, const std::string& text) {
  std::error_code error;
  if (fs::file_size(file, error) != text.size() || error) return false;
  const std::vector<std::uint8_t> bytes = read_whole_file(file);
  return std::equal(bytes.begin(), bytes.end(), text.begin(), text.end(),
                    [](std::uint8_t a, char b) { return a == std::uint8_t(b); });
}

/// The overviews that no page lists yet, in their order.
class OverviewsLeft {
 public:
  explicit OverviewsLeft(const std::vector<SceneCell>& overviews) {
    for (const SceneCell& overview : overviews) left_.push_back(&overview);
    std::ranges::sort(left_, [](const SceneCell* a, const SceneCell* b) { return is_overview_before(*a, *b); });
    if (!left_.empty()) highest_ = left_.back()->own_lod();
  }

  /// Moves the overviews that lie in one of the sorted blocks to that block, except overviews of the highest level.
  void move_to(std::vector<Block>& blocks) {
    std::map<Vec3i64, Block*> at;
    for (Block& block : blocks) at[block.block.min] = &block;
    const std::int64_t edge = blocks.front().block.edge;
    std::erase_if(left_, [&](const SceneCell* overview) {
      const auto block = at.find(block_around(overview->lattice_min, edge).min);
      if (overview->own_lod() == highest_ || block == at.end() || !lies_in(*overview, block->second->block))
        return false;
      block->second->overviews.push_back(overview);
      return true;
    });
  }

  std::vector<SceneCell> taken() const {
    std::vector<SceneCell> overviews;
    for (const SceneCell* overview : left_) overviews.push_back(*overview);
    return overviews;
  }

 private:
  std::vector<const SceneCell*> left_;
  std::uint32_t highest_ = 0;  ///< own_lod() of the highest overview level
};

class PageWriter {
 public:
  PageWriter(const fs::path& scene_xml, const SceneDescription& scene)
      : folder_(scene_xml.parent_path()), scene_(scene), pool_(host_limits().cores()), overviews_(scene.overviews) {
    std::error_code error;
    fs::create_directories(folder_ / page_folder, error);
    if (error) throw InputError(folder_ / page_folder, "", "cannot make the folder: " + error.message());
  }

  const OverviewsLeft& overviews() const { return overviews_; }

  std::vector<PageReference> of_cells(std::vector<const SceneCell*> cells, std::int64_t edge) {
    auto blocks = blocks_of(cells, edge, [](const SceneCell* cell) { return cell->lattice_min; });
    overviews_.move_to(blocks);
    return written(
        blocks, [&](std::size_t i, PageReference& page) { page.totals.add(*cells[i]); },
        [&](std::size_t i, pugi::xml_node root) { append_cell(root, scene_, *cells[i]); });
  }

  std::vector<PageReference> of_pages(std::vector<PageReference> pages, std::int64_t edge) {
    auto blocks = blocks_of(pages, edge, [](const PageReference& page) { return page.block.min; });
    overviews_.move_to(blocks);
    return written(
        blocks, [&](std::size_t i, PageReference& page) { page.totals.add(pages[i].totals), ++page.groups; },
        [&](std::size_t i, pugi::xml_node root) { append_reference(root, scene_, pages[i]); });
  }

 private:
  /// Writes one page per block. For each item, `count` adds it to the page's totals and `append` writes its line.
  template <class Count, class Append>
  std::vector<PageReference> written(const std::vector<Block>& blocks, const Count& count, const Append& append) const {
    std::vector<PageReference> pages(blocks.size());
    pool_.parallel_for(blocks.size(), 1, [&](std::size_t b, std::size_t, int) {
      PageReference& page = pages[b];
      page.block = blocks[b].block;
      for (std::size_t i = blocks[b].begin; i < blocks[b].end; ++i) count(i, page);
      for (const SceneCell* overview : blocks[b].overviews) page.totals.add(*overview);
      pugi::xml_document document;
      pugi::xml_node root = document.append_child("OctTreeGroup");
      set_schema(root, newest_page_version);
      set_lattice(root, scene_);
      set_block(root, page.block);
      set_number(root, "Groups", page.groups);
      set_totals(root, page.totals);
      for (std::size_t i = blocks[b].begin; i < blocks[b].end; ++i) append(i, root);
      append_overviews(root, scene_, blocks[b].overviews);
      publish(summed_text(document), page);
    });
    return pages;
  }

  void publish(const SummedText& text, PageReference& page) const {
    page.checksum = text.checksum;
    const std::int64_t edge = page.block.edge;
    page.file = fmt::format("{}/g_{}_{}_{}_{}-{}.xml", page_folder, page.block.min[0] / edge, page.block.min[1] / edge,
                            page.block.min[2] / edge, edge, text.checksum.hex());
    if (!holds(folder_ / page.file, text.text)) publish_file(folder_ / page.file, text.text, Durability::while_up);
  }

  fs::path folder_;
  const SceneHeader& scene_;
  ThreadPool pool_;
  OverviewsLeft overviews_;
};

}  // namespace

ScenePage write_pages(const fs::path& scene_xml, const SceneDescription& scene, const PageRule& rule) {
  PageWriter writer(scene_xml, scene);
  std::vector<const SceneCell*> cells;
  for (const SceneCell& cell : scene.cells) cells.push_back(&cell);
  std::int64_t edge = std::int64_t(scene.cells.at(0).cell_voxels) * rule.block_cells;
  std::vector<PageReference> pages = writer.of_cells(std::move(cells), edge);
  while (pages.size() > rule.max_groups_per_file && edge <= max_block_edge / rule.block_cells)
    pages = writer.of_pages(std::move(pages), edge *= rule.block_cells);
  flush_file_system_of(scene_xml.parent_path() / page_folder);
  return {{}, std::move(pages), writer.overviews().taken()};
}

PageNames page_names(const fs::path& scene_xml) {
  PageNames names;
  PagedScene(scene_xml).for_each_reference(
      [&names](const PageReference& page) { names.insert(fs::path(page.file).filename().string()); });
  return names;
}

void remove_unused_pages(const fs::path& scene_xml, const PageNames& kept) {
  std::error_code error;
  const fs::path folder = scene_xml.parent_path() / page_folder;
  if (!fs::is_directory(folder, error)) return;
  const PageNames used = page_names(scene_xml);
  std::vector<fs::path> unused;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    const std::string name = it->path().filename().string();
    const bool is_page = name.starts_with("g_") && name.ends_with(".xml");
    if ((is_page && !used.contains(name) && !kept.contains(name)) ||
        (name.starts_with(".g_") && name.ends_with(".part")))
      unused.push_back(it->path());
  }
  for (const fs::path& path : unused) fs::remove(path, error);
}

}  // namespace gigabake
