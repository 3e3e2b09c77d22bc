/// The pages that rays asked for, up to a number of bytes; the longest unused goes first.
#pragma once

#include <cstdint>
#include <filesystem>
#include <unordered_map>
#include <vector>

#include "format/scene_xml.h"
#include "kernels/cast_scene.h"
#include "kernels/policy.h"
#include "viewer/cast_pages.h"
#include "viewer/cell_layout.h"
#include "viewer/cell_reader.h"

namespace gigabake {

struct PageCounts {
  std::uint64_t loads = 0;       ///< pages read, each time anew
  std::uint64_t peak_bytes = 0;  ///< of the pages held at once
};

class PageCache {
 public:
  struct Options {
    kernels::CastLight light;
    std::uint64_t memory_bytes = std::uint64_t(1) << 30;  ///< to aim for; what one ray needs at once is always held
  };

  /// Borrows `policy`. scene_path: for messages and to find the shards that they name.
  /// Errors  InputError as lay_out_cells().
  PageCache(const SceneDescription& scene, std::filesystem::path scene_path, CellReader reader, const Options& options,
            const kernels::CpuPolicy& policy);

  /// What is here now; valid until the next load().
  const kernels::CastScene& scene() const { return layout_.scene; }

  /// Before rays are cast: what they look at from now on is in use.
  void begin_pass() { ++layout_.scene.pass; }

  /// Loads what the pass missed; at least one page. What the pass looked at stays, the rest makes room. Pages beyond
  /// the budget are left for a later pass.
  /// missing: pages of CastRay::missing, in any order, with repetitions; no_page is skipped.
  /// Errors  InputError: a shard that cannot be read.
  void load(std::vector<std::uint32_t> missing);

  const PageCounts& counts() const { return counts_; }

 private:
  struct Resident {
    NodePage nodes;  ///< one of the two is empty
    LevelPage level;
    std::uint64_t bytes = 0;
  };

  Resident read(std::uint32_t page) const;
  void enter(std::uint32_t page, Resident resident);
  void evict(std::uint32_t page);
  void make_room();
  std::filesystem::path shard_of(std::uint32_t page) const;

  std::filesystem::path scene_path_;
  std::vector<std::string> files_;  ///< by scene cell
  CellReader reader_;
  Shading shading_;
  std::uint64_t memory_bytes_;
  const kernels::CpuPolicy& policy_;
  CellLayout layout_;
  std::vector<std::uint32_t> page_used_;
  std::unordered_map<std::uint32_t, Resident> residents_;
  std::uint64_t bytes_ = 0;
  PageCounts counts_;
};

}  // namespace gigabake
