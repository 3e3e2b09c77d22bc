#include "format/scene/paged_scene.h"

#include <algorithm>
#include <iterator>
#include <map>
#include <mutex>
#include <tuple>
#include <utility>

#include "format/scene/scene_check.h"
#include "format/scene/scene_reading.h"

namespace gigabake {

bool is_before(const SceneCell& a, const SceneCell& b) {
  return std::tie(a.lattice_min[2], a.lattice_min[1], a.lattice_min[0]) <
         std::tie(b.lattice_min[2], b.lattice_min[1], b.lattice_min[0]);
}

PagedScene::PagedScene(std::filesystem::path scene_xml) : scene_xml_(std::move(scene_xml)) {
  SceneReading reading = read_scene_text(scene_xml_);
  const std::vector<SceneFault> faults = faults_of_listed(reading);
  if (!faults.empty()) throw error_of(scene_xml_, faults[0]);
  totals_ = reading.totals ? std::move(*reading.totals) : SceneTotals(reading.scene);
  root_ = {std::move(reading.scene.cells), std::move(reading.pages)};
  header_ = std::move(reading.scene);
}

PagedScene::PagedScene(std::filesystem::path scene_xml, SceneHeader header, SceneTotals totals, ScenePage root)
    : scene_xml_(std::move(scene_xml)),
      header_(std::move(header)),
      totals_(std::move(totals)),
      root_(std::move(root)) {}

PagedScene PagedScene::of_cells(std::filesystem::path scene_xml, SceneDescription scene) {
  SceneTotals totals(scene);
  std::vector<SceneCell> cells = std::move(scene.cells);
  return {std::move(scene_xml), std::move(scene), std::move(totals), {std::move(cells), {}}};
}

std::vector<PageReference> PagedScene::leaves(const ThreadPool& pool) const {
  std::vector<PageReference> found = root_.pages;
  const auto has_pages = [](const PageReference& page) { return page.groups != 0; };
  while (std::any_of(found.begin(), found.end(), has_pages)) {
    std::vector<std::vector<PageReference>> below(found.size());
    pool.parallel_for(found.size(), 1, [&](std::size_t i, std::size_t, int) {
      if (has_pages(found[i]))
        below[i] = read_page(scene_xml_, header_, found[i]).pages;
      else
        below[i] = {std::move(found[i])};
    });
    found.clear();
    for (std::vector<PageReference>& pages : below) std::move(pages.begin(), pages.end(), std::back_inserter(found));
  }
  return found;
}

void PagedScene::visit_references(const ScenePage& page, const std::function<void(const PageReference&)>& visit) const {
  for (const PageReference& below : page.pages) {
    visit(below);
    if (below.groups != 0) visit_references(read_page(scene_xml_, header_, below), visit);
  }
}

void PagedScene::for_each_reference(const std::function<void(const PageReference&)>& visit) const {
  visit_references(root_, visit);
}

void PagedScene::visit_below(const ScenePage& page, const VisitCells& visit) const {
  if (page.pages.empty()) return visit(page.cells);
  for (const PageReference& below : page.pages) visit_below(read_page(scene_xml_, header_, below), visit);
}

void PagedScene::for_each_page(const VisitCells& visit) const { visit_below(root_, visit); }

PagedScene::VisitCells PagedScene::one_by_one(const VisitCell& visit) {
  return [&visit](std::span<const SceneCell> cells) {
    for (const SceneCell& cell : cells) visit(cell);
  };
}

void PagedScene::for_each_cell(const VisitCell& visit) const { for_each_page(one_by_one(visit)); }

void PagedScene::for_each_cell_below(const PageReference& page, const VisitCell& visit) const {
  visit_below(read_page(scene_xml_, header_, page), one_by_one(visit));
}

void PagedScene::for_each_page(
    const ThreadPool& pool,
    const std::function<void(std::size_t number, std::span<const SceneCell> cells)>& visit) const {
  if (root_.pages.empty()) return visit(0, root_.cells);
  const std::vector<PageReference> pages = leaves(pool);
  pool.parallel_for(pages.size(), 1,
                    [&](std::size_t i, std::size_t, int) { visit(i, read_page(scene_xml_, header_, pages[i]).cells); });
}

void PagedScene::collect(const ScenePage& page, const LatticeBox& box, std::vector<SceneCell>& found) const {
  for (const SceneCell& cell : page.cells)
    if (!intersection(window_of(cell), box).is_empty()) found.push_back(cell);
  for (const PageReference& below : page.pages)
    if (!intersection(below.totals.window, box).is_empty()) collect(read_page(scene_xml_, header_, below), box, found);
}

std::vector<SceneCell> PagedScene::cells_in(const LatticeBox& box) const {
  std::vector<SceneCell> found;
  collect(root_, box, found);
  std::sort(found.begin(), found.end(), is_before);
  return found;
}

std::vector<SceneCell> PagedScene::cells(const ThreadPool& pool) const {
  std::map<std::size_t, std::vector<SceneCell>> of_page;
  std::mutex mutex;
  for_each_page(pool, [&](std::size_t number, std::span<const SceneCell> listed) {
    std::vector<SceneCell> copy(listed.begin(), listed.end());
    const std::scoped_lock lock(mutex);
    of_page.emplace(number, std::move(copy));
  });
  std::vector<SceneCell> all;
  all.reserve(totals_.cells);
  for (auto& [number, cells] : of_page) {
    std::move(cells.begin(), cells.end(), std::back_inserter(all));
    cells = {};
  }
  return all;
}

SceneDescription PagedScene::all(const ThreadPool& pool) const {
  SceneDescription scene;
  static_cast<SceneHeader&>(scene) = header_;
  scene.cells = cells(pool);
  if (!root_.pages.empty()) std::sort(scene.cells.begin(), scene.cells.end(), is_before);
  return scene;
}

}  // namespace gigabake
