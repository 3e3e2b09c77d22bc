#include <atomic>
#include <bit>
#include <chrono>
#include <future>
#include <optional>
#include <string>
#include <thread>
#include <utility>

#include "core/base/error.h"
#include "viewer/stream/page.h"

namespace gigabake {
namespace {

[[noreturn]] void refuse_page(const PageKey& key, const std::string& what) {
  const std::string part = key.part == PageKey::node_rows ? "nodes"
                           : key.part < 0                 ? "list of cells"
                                                          : "level " + std::to_string(key.part);
  throw InputError("producer",
                   "shard " + std::to_string(key.shard) + ", " + part + ", block " + std::to_string(key.block), what);
}

/// Returns the fault of the rows; empty if there is none. VoxelLookup checks the references to other rows when it
/// follows them.
std::string fault_of_rows(const std::vector<NodeRow>& rows) {
  if (rows.empty() || rows.size() > nodes_per_block)
    return "expected 1 to " + std::to_string(nodes_per_block) + " rows, got " + std::to_string(rows.size());
  for (const NodeRow& row : rows) {
    if (row.kind > NodeKind::leaf_constant) return "a node of unknown type";
    if (row.kind == NodeKind::leaf_constant && row.child_mask != 0) return "a leaf with children";
    if ((row.leaf_mask & row.child_mask) != 0 || (row.leaf_mask != 0 && row.kind == NodeKind::leaf_constant))
      return "a leaf in an octant with a child";
    if (row.child_mask != 0 && row.first_child > 0xffffffffu - 8) return "children beyond every table";
    if (!is_plane(row.directional_coverage[directional_coverage_plane])) return "an invalid plane";
  }
  return {};
}

std::string fault_of_bricks(const BrickBlock& block, bool has_normals) {
  const std::size_t bricks = block.mask.size() / brick_edge;
  if (bricks == 0 || bricks > bricks_per_block || block.mask.size() % brick_edge != 0)
    return "expected 1 to " + std::to_string(bricks_per_block) + " bricks of 8 words";
  if (block.first.size() != bricks + 1 || block.first[0] != 0) return "first does not match mask";
  for (std::size_t b = 0; b < bricks; ++b) {
    std::uint32_t voxels = 0;
    for (std::size_t z = 0; z < brick_edge; ++z) voxels += std::uint32_t(std::popcount(block.mask[brick_edge * b + z]));
    if (block.first[b + 1] != block.first[b] + voxels) return "first does not match mask";
  }
  const std::size_t voxels = block.first[bricks];
  if (block.rgba.size() != 4 * voxels) return "expected 4 bytes of rgba per voxel";
  if (block.normal.size() != (has_normals ? 2 * voxels : 0)) return "normals do not match the channels of the scene";
  if (!block.directional_coverage.empty() && block.directional_coverage.size() != directional_coverage_bytes * voxels)
    return "facing does not match the voxels";
  if (!block.voxel_class.empty() && block.voxel_class.size() != voxels) return "classes do not match the voxels";
  for (std::size_t v = 0; v < block.directional_coverage.size(); v += directional_coverage_bytes)
    if (!is_plane(block.directional_coverage[v + directional_coverage_plane])) return "an invalid plane";
  return {};
}

/// The result of a call of the producer. An error is returned as text, because two threads would otherwise share the
/// exception, and the later one would free it.
struct Outcome {
  std::optional<Page> page;
  std::string problem;
  bool names_page = false;  ///< the problem is the message of an InputError
};

Outcome outcome_of(const PageSource& producer, const PageKey& key) {
  try {
    return {producer(key), {}, false};
  } catch (const InputError& error) {
    return {{}, error.what(), true};
  } catch (const std::exception& error) {
    return {{}, error.what(), false};
  } catch (...) {
    return {{}, "it failed for an unknown reason", false};
  }
}

/// Returns the page, or throws the problem. Adds the page's name to a problem that lacks it.
Page page_of(const PageKey& key, Outcome outcome) {
  if (outcome.page) return std::move(*outcome.page);
  if (outcome.names_page) throw InputError("", "", outcome.problem);
  refuse_page(key, outcome.problem);
}

class Guard {
 public:
  Guard(PageSource producer, const SceneHeader& scene, const ProducerLimits& limits)
      : producer_(std::make_shared<PageSource>(std::move(producer))),
        has_normals_(scene.has_normals),
        limits_(limits) {}

  Page operator()(const PageKey& key) {
    Page page = in_time(key);
    if (page.bytes() > limits_.max_page_bytes)
      refuse_page(key,
                  std::to_string(page.bytes()) + " bytes; expected at most " + std::to_string(limits_.max_page_bytes));
    const bool rows = key.part == PageKey::node_rows, bricks = key.part >= 0;
    if ((!rows && !page.rows.empty()) || (!bricks && !page.bricks.mask.empty()))
      refuse_page(key, "it is a page of another type");
    std::string fault;
    if (rows) fault = fault_of_rows(page.rows);
    if (bricks) fault = fault_of_bricks(page.bricks, has_normals_);
    if (!fault.empty()) refuse_page(key, fault);
    return page;
  }

 private:
  Page in_time(const PageKey& key) {
    if (limits_.seconds <= 0) return page_of(key, outcome_of(*producer_, key));
    if (late_ >= limits_.max_late)
      refuse_page(key, "it was late " + std::to_string(limits_.max_late) + " times and is not requested again");
    std::packaged_task<Outcome()> task([producer = producer_, key] { return outcome_of(*producer, key); });
    std::future<Outcome> outcome = task.get_future();
    std::thread(std::move(task)).detach();
    if (outcome.wait_for(std::chrono::duration<double>(limits_.seconds)) != std::future_status::ready) {
      ++late_;
      refuse_page(key, "no page within " + std::to_string(limits_.seconds) + " s");
    }
    return page_of(key, outcome.get());
  }

  std::shared_ptr<PageSource> producer_;
  bool has_normals_;
  ProducerLimits limits_;
  std::atomic<int> late_{0};
};

}  // namespace

PageSource guarded_pages(PageSource producer, const SceneHeader& scene, const ProducerLimits& limits) {
  return [guard = std::make_shared<Guard>(std::move(producer), scene, limits)](const PageKey& key) {
    return (*guard)(key);
  };
}

}  // namespace gigabake
