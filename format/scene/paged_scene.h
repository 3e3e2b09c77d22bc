/// A scene for whoever goes from cell to cell: scene.xml is read at once, pages when they are come to.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "format/scene/scene_page.h"
#include "format/scene/scene_totals.h"
#include "lattice/thread_pool.h"

namespace gigabake {

/// Errors (all)  InputError: scene.xml or a page that cannot be read, or does not agree with what is above it: the file
///               and what to do. Ancestors of what was asked for are checked, other pages are not looked at.
/// Any number of threads may use one at a time.
class PagedScene {
 public:
  explicit PagedScene(std::filesystem::path scene_xml);
  /// Reads no page and no cell.
  static PagedScene of_cells(std::filesystem::path scene_xml, SceneDescription scene);

  const std::filesystem::path& file() const { return scene_xml_; }
  std::filesystem::path folder() const { return scene_xml_.parent_path(); }
  const SceneHeader& header() const { return header_; }
  /// As scene.xml says, or else the sums over its cells.
  const SceneTotals& totals() const { return totals_; }
  /// What scene.xml itself lists: its cells, or references to pages; and parents, among them the root of all.
  const ScenePage& root() const { return root_; }

  /// The pages that list cells, in their order. Cost  reads the pages above them, on the pool's threads.
  /// visit_above: called with each of those, with root() first, in the same order at every call.
  std::vector<PageReference> leaves(const ThreadPool& pool = callers_thread(),
                                    const std::function<void(const ScenePage&)>& visit_above = {}) const;

  /// Every page above its own, those that list cells too.
  void for_each_reference(const std::function<void(const PageReference&)>& visit) const;

  using VisitCells = std::function<void(std::span<const SceneCell> cells)>;
  /// Page by page in their order, one in memory; a scene without pages counts as one.
  void for_each_page(const VisitCells& visit) const;
  using VisitCell = std::function<void(const SceneCell& cell)>;
  void for_each_cell(const VisitCell& visit) const;
  void for_each_cell_below(const PageReference& page, const VisitCell& visit) const;
  /// On the pool's threads, in no particular order; a page in memory for each. number: of the page in their order.
  void for_each_page(const ThreadPool& pool,
                     const std::function<void(std::size_t number, std::span<const SceneCell> cells)>& visit) const;

  /// Of all pages: a page's own, then those of each page below it. So they are numbered.
  void for_each_parent(const VisitCell& visit) const;
  void for_each_parent_below(const PageReference& page, const VisitCell& visit) const;
  std::vector<SceneCell> parents() const;

  /// Cells whose windows overlap the box, by lattice_min z, y, x. Cost  reads pages that may have such.
  std::vector<SceneCell> cells_in(const LatticeBox& box) const;
  /// Parents that overlap it and have that level of their own. Cost  as cells_in().
  std::vector<SceneCell> parents_in(const LatticeBox& box, int lod) const;

  /// All cells, in the order of the pages.
  std::vector<SceneCell> cells(const ThreadPool& pool = callers_thread()) const;
  /// All cells, sorted by lattice_min z, y, x, and all parents.
  SceneDescription all(const ThreadPool& pool = callers_thread()) const;

 private:
  PagedScene(std::filesystem::path scene_xml, SceneHeader header, SceneTotals totals, ScenePage root);
  static VisitCells one_by_one(const VisitCell& visit);
  void visit_below(const ScenePage& page, const VisitCells& visit) const;
  void visit_references(const ScenePage& page, const std::function<void(const PageReference&)>& visit) const;
  void visit_parents(const ScenePage& page, const VisitCell& visit) const;
  void collect(const ScenePage& page, const LatticeBox& box, std::vector<SceneCell>& found) const;
  void collect_parents(const ScenePage& page, const LatticeBox& box, int lod, std::vector<SceneCell>& found) const;

  std::filesystem::path scene_xml_;
  SceneHeader header_;
  SceneTotals totals_;
  ScenePage root_;
};

/// As cells are sorted in a scene.
bool is_before(const SceneCell& a, const SceneCell& b);
/// As parents are: each after its children.
bool is_parent_before(const SceneCell& a, const SceneCell& b);

}  // namespace gigabake
