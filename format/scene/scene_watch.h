/// A scene whose cells are being baked, as viewers show it.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/base/rules.h"
#include "format/scene/xml/scene_xml.h"

namespace gigabake {

enum class CellState : std::uint8_t {
  waiting,
  baking,
  failed,  ///< permanently
  done,    ///< baked or found empty
};
template <>
constexpr auto names_of<CellState>() {
  return std::to_array<std::string_view>({"waiting", "baking", "failed", "done"});
}

/// The cells of a running bake. Their number and their places are fixed; shards and states change.
struct WatchedScene {
  std::uint64_t bake = 0;  ///< differs between bakes
  /// A cell without a shard has no `file`. A cell that is not done has the shard of the previous scene, if there is
  /// one. The last cells may be cells of the previous scene only.
  SceneDescription scene;
  std::vector<CellState> states;  ///< per cell
};

/// Information on one cell.
struct CellFacts {
  std::string name;
  CellState state = CellState::waiting;
  std::uint64_t triangles = 0;  ///< an estimate until the cell is done
  double cost = 0;              ///< fraction of the whole bake's cost
  double seconds = 0;           ///< reading, kernels and writing; 0 if not recorded
  std::uint64_t voxels = 0;     ///< lod 0
  std::vector<std::string> tiles;
  std::string error;  ///< set if the cell failed
};

/// A source of a watched scene.
class SceneWatch {
 public:
  virtual ~SceneWatch() = default;

  /// Returns the current scene, valid until the next call; null if the published scene should be shown. Replaces
  /// `changed` by the cells whose shard or state has changed since the previous call; a new bake lists none.
  /// Errors  InputError: a file of the bake is unreadable.
  virtual const WatchedScene* poll(std::vector<std::uint32_t>& changed) = 0;
  /// Returns the facts of a cell of the scene that poll() returned last. Thread-safe.
  virtual CellFacts facts(std::uint32_t cell) const = 0;
};

}  // namespace gigabake
