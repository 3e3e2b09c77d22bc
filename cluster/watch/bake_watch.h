/// The watch of a bake in its folder OUT, from any host that sees OUT. It reads OUT/status.json, OUT/plan, OUT/journal
/// and the previous scene.xml, and writes nothing.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "cluster/watch/observed_status.h"
#include "format/scene/scene_watch.h"
#include "format/system/file_stamp.h"
#include "scheduler/journal/journal_tail.h"
#include "scheduler/journal/plan_record.h"

namespace gigabake {

/// Shows the bake while it runs and its cells are planned, and after its interruption if there is no scene.xml. Does
/// not show a bake that changes few cells of a published scene, such as an edit: viewers keep this scene and exchange
/// these cells at the end.
/// A cell is done if the journal has a record of its fingerprint and OUT has its shard.
/// Exact   A previous scene is shown only if it has the same lattice, place, channels and cell size. Its cells that
///         overlap a planned cell at another place are omitted.
class BakeWatch : public SceneWatch {
 public:
  /// A bake changes few cells if it has to bake at most `few_cells` of them, or an eighth.
  explicit BakeWatch(std::filesystem::path out, std::size_t few_cells = 8);

  const WatchedScene* poll(std::vector<std::uint32_t>& changed) override;
  CellFacts facts(std::uint32_t cell) const override;

 private:
  struct LowHalf {
    std::size_t operator()(const Hash128& h) const { return std::size_t(h.lo); }
  };
  struct Finished {
    FileStamp shard;
    double seconds = 0;
    std::uint64_t voxels = 0;
  };

  bool shows_plan();
  bool changes_little() const;
  bool load_plan();
  void index_cells();
  void add_previous();
  void add_previous_cell(const SceneCell& cell);
  bool overlaps_planned(const SceneCell& cell) const;
  void take(const Hash128& fingerprint, const CellReport& report);
  bool has_shard(const SceneCell& planned, const SceneCell& baked) const;
  void take_unseen();
  void take_failures();
  void take_running();
  void set_state(std::uint32_t cell, CellState state);

  const std::filesystem::path out_;
  const std::size_t few_cells_;
  std::optional<ObservedStatus> status_;
  FileStamp status_stamp_;
  double observed_s_ = 0;  ///< Unix time of the last observation

  mutable std::mutex mutex_;      ///< guards all members below
  bool is_small_change_ = false;  ///< plan_ changes few cells
  double started_s_ = -1;         ///< BakeStatus::started_s of the bake that wrote plan_; -1: there is no plan
  PlanRecord plan_;
  WatchedScene watched_;
  std::vector<Finished> finished_;               ///< per planned cell
  std::map<std::uint32_t, std::string> errors_;  ///< of failed cells
  std::unordered_map<Hash128, std::uint32_t, LowHalf> by_fingerprint_;
  std::unordered_map<std::string, std::uint32_t> by_name_;
  std::map<std::array<std::int64_t, 2>, std::map<std::int64_t, std::uint32_t>> columns_;  ///< planned cells by x, y; z
  std::vector<std::uint32_t> baking_;
  std::unordered_map<Hash128, CellReport, LowHalf> unseen_;  ///< records of shards that this host does not see
  bool looks_for_shards_ = false;
  std::optional<JournalTail> journal_;
  std::uint64_t failures_at_ = 0;
  std::vector<std::uint32_t> changed_;
};

}  // namespace gigabake
