/// A scene that fits nowhere, streamed to where rays are cast: what they want is read, filled and put into the pools,
/// most urgent first. Where all of it hangs from a root parent, that is all there is at first, and cells come as rays
/// go down to them; else there is a tree to each cell.
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "format/scene/paged_scene.h"
#include "kernels/cast/caster.h"
#include "viewer/light/shading.h"
#include "viewer/stream/cell_layout.h"
#include "viewer/stream/pager.h"
#include "viewer/stream/pool_books.h"
#include "viewer/stream/shard_map.h"
#include "viewer/stream/voxel_lookup.h"

namespace gigabake {

class SceneStream {
 public:
  struct Options {
    kernels::CastLight light;
    Surface surface = Surface::colour;
    std::uint64_t memory_bytes = std::uint64_t(1) << 30;  ///< of pools and pages together; UINT64_MAX: half of the host
    int page_threads = 2;
    std::optional<int>
        cuda_device;  ///< cast there (an ordinal of cuda_devices()); the pools are then not of memory_bytes
    std::uint64_t device_bytes = std::uint64_t(4) << 30;  ///< of those pools
    bool cells_alone = false;  ///< no parents, whatever the scene has: all cells are known from the start
  };

  /// What stays in the pools: what rays used in this pass of theirs or a later one, where `all`; else only as long as
  /// anything else can go.
  struct Keep {
    std::uint32_t used_since = 0;
    bool all = true;
  };

  /// What one call of serve() did.
  struct Served {
    std::uint64_t uploads = 0;
    bool evicted_used = false;  ///< the pools do not hold what one pass of the rays uses
    bool is_full = false;       ///< something was left out, since all in the pools is in use
  };

  /// Borrows policy.
  /// Errors  InputError as lay_out_cells(); UsageError: less memory than the scene's roots take; CudaFailure, from all
  ///         members that have to do with the caster.
  SceneStream(const PagedScene& scene, PageSource source, const Options& options, const ThreadPool& policy);

  kernels::Caster& caster() { return *caster_; }
  const CellLayout& layout() const { return layout_; }

  /// Puts in what rays wanted (Caster::wanted()), as far as its pages are here, until `enough`; at least one batch.
  /// What lacks pages is asked of the pager. eye: lod-0 voxels; near and coarse goes first.
  Served serve(const std::vector<std::uint32_t>& wanted, const double eye[3], const kernels::StopAsked& enough,
               const Keep& keep);

  /// Takes in what was read since.
  void begin_pass() { pager_.begin_pass(); }
  /// Until something was read, or nothing is being read. False: the time was over before.
  bool wait(std::chrono::milliseconds most) { return pager_.wait(most); }
  /// Until nothing is being read. False: the time was over before.
  bool settle(std::chrono::milliseconds most) { return pager_.settle(most); }
  bool has_arrivals() const { return pager_.has_arrivals(); }

  /// From now on each serve() puts in the cells' roots, too, whether rays want them or not, where the pools have room
  /// for all of them: something then stands for all of the scene, from wherever it is looked at.
  void want_roots();
  /// Whether some of them are still to come.
  bool lacks_roots() const { return !absent_roots_.empty(); }

  /// Rays of so many pixels a side are cast together where a picture is made in tiles: enough to share what they wait
  /// for and to fill a GPU, few enough to need little and to end soon.
  int tile_edge() const { return tile_edge_; }

  /// Pools, wherever they are, and pages.
  std::uint64_t bytes_allowed() const { return pool_bytes_ + page_bytes_; }
  /// What is in use of the pools, and pages.
  std::uint64_t bytes_held() const { return books_.in_use().bytes() + pager_.counts().bytes; }
  std::uint64_t page_bytes_allowed() const { return page_bytes_; }
  PagerCounts page_counts() const { return pager_.counts(); }
  std::uint64_t uploads() const { return uploads_; }  ///< bricks and node tiles put into the pools so far
  /// One line for each page that could not be read.
  std::vector<std::string> problems() const { return pager_.problems(); }

 private:
  struct Answer;
  struct Opened {
    CellLayout layout;
    ShardMap map;
  };
  static Opened open(const PagedScene& scene, const Options& options, const ThreadPool& policy);
  SceneStream(const PagedScene& scene, Opened opened, PageSource source, const Options& options,
              const ThreadPool& policy);

  void answer(std::uint32_t want, Answer& out, kernels::CastBrick& brick) const;
  bool enter(std::uint32_t want, const Answer& answer, kernels::CastBrick& brick);
  std::vector<std::uint32_t> by_urgency(const std::vector<std::uint32_t>& wanted, const double eye[3]) const;
  bool has_come(std::uint32_t want) const;
  double urgency(std::uint32_t want, const double eye[3]) const;
  void forget_roots_that_came();

  const ThreadPool& policy_;
  std::uint64_t page_bytes_, pool_bytes_;
  int tile_edge_;
  CellLayout layout_;
  ShardMap map_;
  Shading shading_;
  Pager pager_;
  VoxelLookup lookup_;
  PoolBooks books_;
  std::unique_ptr<kernels::Caster> caster_;
  bool wants_roots_ = false;
  std::vector<std::uint32_t> absent_roots_;  ///< wants
  std::vector<std::uint32_t> new_slots_;
  std::vector<kernels::CastBrick> new_bricks_;
  std::uint64_t uploads_ = 0;
};

}  // namespace gigabake
