/// A scene that is read on demand: scene.xml when the scene is opened, pages when they are visited.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "core/base/thread_pool.h"
#include "core/math/box3.h"
#include "format/scene/scene_page.h"

namespace gigabake {

/// Reader of a scene's cells and overviews. Thread-safe: any number of threads may use the same PagedScene
/// concurrently.
/// Errors  All members throw InputError if scene.xml or a page cannot be read, or if a page contradicts the page that
///         refers to it. The message has the file and the remedy. Only requested pages and the pages above them are
///         read and checked.
class PagedScene {
 public:
  explicit PagedScene(std::filesystem::path scene_xml);
  /// Returns a scene over cells in memory. Reads no file.
  static PagedScene of_cells(std::filesystem::path scene_xml, SceneDescription scene);

  const std::filesystem::path& file() const { return scene_xml_; }
  std::filesystem::path folder() const { return scene_xml_.parent_path(); }
  const SceneHeader& header() const { return header_; }
  /// Returns the totals stored in scene.xml, or, if it has none, the sums over its cells.
  const SceneTotals& totals() const { return totals_; }
  /// Returns the lists in scene.xml itself: cells or page references, and overviews, including the root overview.
  const ScenePage& root() const { return root_; }

  /// Returns references to the pages that list cells, in the order of the pages. Calls `visit_above` with each page
  /// above these pages, root() first, in the same order at every call.
  /// Cost    Reads the pages that refer to other pages, on the pool's threads.
  std::vector<PageReference> leaves(const ThreadPool& pool = callers_thread(),
                                    const std::function<void(const ScenePage&)>& visit_above = {}) const;

  /// Visits every reference to a page, including pages that list cells. A page precedes the pages below it.
  void for_each_reference(const std::function<void(const PageReference&)>& visit) const;

  using VisitCells = std::function<void(std::span<const SceneCell> cells)>;
  /// Visits the cells page by page, in the order of the pages, with one page in memory. A scene without pages counts as
  /// one page.
  void for_each_page(const VisitCells& visit) const;
  using VisitCell = std::function<void(const SceneCell& cell)>;
  void for_each_cell(const VisitCell& visit) const;
  void for_each_cell_below(const PageReference& page, const VisitCell& visit) const;
  /// Visits the pages on the pool's threads, in no particular order, with one page per thread in memory. `number` is
  /// the page's index in the order of the pages.
  void for_each_page(const ThreadPool& pool,
                     const std::function<void(std::size_t number, std::span<const SceneCell> cells)>& visit) const;

  /// Visits the overviews of all pages: each page's own, then the overviews of each page below it. Overviews are
  /// numbered in this order.
  void for_each_overview(const VisitCell& visit) const;
  void for_each_overview_below(const PageReference& page, const VisitCell& visit) const;
  std::vector<SceneCell> overviews() const;

  /// Returns the cells whose windows overlap the box, sorted by z, y, x of lattice_min.
  /// Cost    Reads the pages that may contain such cells.
  std::vector<SceneCell> cells_in(const Box3i64& box) const;
  /// Returns the overviews whose windows overlap the box and whose own levels (not duplicated ones) include `lod`.
  /// Cost    See cells_in().
  std::vector<SceneCell> overviews_in(const Box3i64& box, int lod) const;

  /// Returns all cells, in the order of the pages.
  std::vector<SceneCell> cells(const ThreadPool& pool = callers_thread()) const;
  /// Returns all cells, sorted by lattice_min z, y, x, and all overviews.
  SceneDescription all(const ThreadPool& pool = callers_thread()) const;

 private:
  PagedScene(std::filesystem::path scene_xml, SceneHeader header, SceneTotals totals, ScenePage root);
  static VisitCells one_by_one(const VisitCell& visit);
  void visit_below(const ScenePage& page, const VisitCells& visit) const;
  void visit_references(const ScenePage& page, const std::function<void(const PageReference&)>& visit) const;
  void visit_overviews(const ScenePage& page, const VisitCell& visit) const;
  void collect(const ScenePage& page, const Box3i64& box, std::vector<SceneCell>& found) const;
  void collect_overviews(const ScenePage& page, const Box3i64& box, int lod, std::vector<SceneCell>& found) const;

  std::filesystem::path scene_xml_;
  SceneHeader header_;
  SceneTotals totals_;
  ScenePage root_;
};

/// Returns whether cell `a` precedes `b` in a scene.
bool is_before(const SceneCell& a, const SceneCell& b);
/// Returns whether overview `a` precedes `b` in a scene: each overview follows its children.
bool is_overview_before(const SceneCell& a, const SceneCell& b);

}  // namespace gigabake
