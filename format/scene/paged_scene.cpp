#include "format/scene/paged_scene.h"

#include <algorithm>
#include <iterator>
#include <map>
#include <mutex>
#include <tuple>
#include <utility>

#include "format/scene/check/scene_check.h"
#include "format/scene/xml/scene_reading.h"

namespace gigabake {

namespace {

Vec3i64 lattice_order(const SceneCell& c) { return c.lattice_min.zyx(); }

}  // namespace

bool is_before(const SceneCell& a, const SceneCell& b) { return lattice_order(a) < lattice_order(b); }

bool is_overview_before(const SceneCell& a, const SceneCell& b) {
  return std::pair(a.own_lod(), lattice_order(a)) < std::pair(b.own_lod(), lattice_order(b));
}

PagedScene::PagedScene(std::filesystem::path scene_xml) : scene_xml_(std::move(scene_xml)) {
  SceneReading reading = read_scene_text(scene_xml_);
  const std::vector<SceneFault> faults = faults_of_listed(reading);
  if (!faults.empty()) throw error_of(scene_xml_, faults[0]);
  totals_ = reading.totals ? std::move(*reading.totals) : SceneTotals(reading.scene);
  root_ = {std::move(reading.scene.cells), std::move(reading.pages), std::move(reading.scene.overviews)};
  header_ = std::move(reading.scene);
}

PagedScene::PagedScene(std::filesystem::path scene_xml, SceneHeader header, SceneTotals totals, ScenePage root)
    : scene_xml_(std::move(scene_xml)),
      header_(std::move(header)),
      totals_(std::move(totals)),
      root_(std::move(root)) {}

PagedScene PagedScene::of_cells(std::filesystem::path scene_xml, SceneDescription scene) {
  SceneTotals totals(scene);
  ScenePage root{std::move(scene.cells), {}, std::move(scene.overviews)};
  return {std::move(scene_xml), std::move(scene), std::move(totals), std::move(root)};
}

std::vector<PageReference> PagedScene::leaves(const ThreadPool& pool,
                                              const std::function<void(const ScenePage&)>& visit_above) const {
  std::vector<PageReference> found = root_.pages;
  if (visit_above) visit_above(root_);
  const auto has_pages = [](const PageReference& page) { return page.groups != 0; };
  while (std::any_of(found.begin(), found.end(), has_pages)) {
    std::vector<ScenePage> below(found.size());
    pool.parallel_for(found.size(), 1, [&](std::size_t i, std::size_t, int) {
      if (has_pages(found[i]))
        below[i] = read_page(scene_xml_, header_, found[i]);
      else
        below[i].pages = {found[i]};
    });
    for (std::size_t i = 0; visit_above && i < found.size(); ++i)
      if (has_pages(found[i])) visit_above(below[i]);
    found.clear();
    for (ScenePage& page : below) std::move(page.pages.begin(), page.pages.end(), std::back_inserter(found));
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

void PagedScene::collect(const ScenePage& page, const Box3i64& box, std::vector<SceneCell>& found) const {
  for (const SceneCell& cell : page.cells)
    if (!intersection(window_of(cell), box).is_empty()) found.push_back(cell);
  for (const PageReference& below : page.pages)
    if (!intersection(below.totals.window, box).is_empty()) collect(read_page(scene_xml_, header_, below), box, found);
}

std::vector<SceneCell> PagedScene::cells_in(const Box3i64& box) const {
  std::vector<SceneCell> found;
  collect(root_, box, found);
  std::sort(found.begin(), found.end(), is_before);
  return found;
}

void PagedScene::visit_overviews(const ScenePage& page, const VisitCell& visit) const {
  for (const SceneCell& overview : page.overviews) visit(overview);
  for (const PageReference& below : page.pages)
    if (below.totals.overviews != 0) visit_overviews(read_page(scene_xml_, header_, below), visit);
}

void PagedScene::for_each_overview(const VisitCell& visit) const { visit_overviews(root_, visit); }

void PagedScene::for_each_overview_below(const PageReference& page, const VisitCell& visit) const {
  if (page.totals.overviews != 0) visit_overviews(read_page(scene_xml_, header_, page), visit);
}

std::vector<SceneCell> PagedScene::overviews() const {
  std::vector<SceneCell> all;
  all.reserve(totals_.overviews);
  for_each_overview([&all](const SceneCell& overview) { all.push_back(overview); });
  return all;
}

/// Adds the overviews of a page and of the pages below it. Skips pages whose block does not overlap the box, because a
/// page's overviews lie in its block.
void PagedScene::collect_overviews(const ScenePage& page, const Box3i64& box, int lod,
                                   std::vector<SceneCell>& found) const {
  for (const SceneCell& overview : page.overviews)
    if (int(overview.own_lod()) <= lod && lod < int(overview.first_lod + overview.lods) &&
        !intersection(window_of(overview), box).is_empty())
      found.push_back(overview);
  for (const PageReference& below : page.pages)
    if (below.totals.overviews != 0 && below.totals.voxels.size() > std::size_t(lod) &&
        !intersection(below.block.box(), box).is_empty())
      collect_overviews(read_page(scene_xml_, header_, below), box, lod, found);
}

std::vector<SceneCell> PagedScene::overviews_in(const Box3i64& box, int lod) const {
  std::vector<SceneCell> found;
  collect_overviews(root_, box, lod, found);
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

/// Reads each page once, for its cells and its overviews.
SceneDescription PagedScene::all(const ThreadPool& pool) const {
  SceneDescription scene;
  static_cast<SceneHeader&>(scene) = header_;
  const auto take_overviews = [&scene](const ScenePage& page) {
    scene.overviews.insert(scene.overviews.end(), page.overviews.begin(), page.overviews.end());
  };
  const std::vector<PageReference> pages = leaves(pool, take_overviews);
  scene.cells = root_.cells;
  if (pages.empty()) return scene;
  scene.cells.reserve(totals_.cells);
  std::mutex mutex;
  pool.parallel_for(pages.size(), 1, [&](std::size_t i, std::size_t, int) {
    ScenePage page = read_page(scene_xml_, header_, pages[i]);
    const std::scoped_lock lock(mutex);
    std::move(page.cells.begin(), page.cells.end(), std::back_inserter(scene.cells));
    take_overviews(page);
  });
  std::sort(scene.cells.begin(), scene.cells.end(), is_before);
  std::sort(scene.overviews.begin(), scene.overviews.end(), is_overview_before);
  return scene;
}

}  // namespace gigabake
