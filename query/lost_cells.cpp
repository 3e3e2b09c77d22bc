#include "query/lost_cells.h"

#include <algorithm>
#include <charconv>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "core/base/error.h"

namespace gigabake {
namespace {

constexpr std::string_view cell_prefix = "cell ";

/// The numbers of a name `c_X_Y_Z`.
struct CellPlace {
  Vec3i64 at{};
};

std::optional<CellPlace> place_of(std::string_view name) {
  if (!name.starts_with("c_")) return {};
  const char *next = name.data() + 2, *end = name.data() + name.size();
  CellPlace place;
  for (std::size_t a = 0; a < 3; ++a) {
    const auto [after, error] = std::from_chars(next, end, place.at[a]);
    if (error != std::errc() || (a < 2 ? after == end || *after != '_' : after != end)) return {};
    next = after + 1;
  }
  return place;
}

using StackColumn = std::pair<std::int64_t, std::int64_t>;

/// Returns the base of the stack in each column that has cells.
std::map<StackColumn, std::int64_t> stack_bases(const std::vector<SceneCell>& cells) {
  std::map<StackColumn, std::int64_t> bases;
  for (const SceneCell& cell : cells)
    if (const auto place = place_of(cell.name))
      bases[{place->at[0], place->at[1]}] = cell.lattice_min[2] - place->at[2] * std::int64_t(cell.cell_voxels);
  return bases;
}

SceneCell placeholder(const std::string& name, const SceneCell& like, const Vec3i64& min) {
  SceneCell cell;
  cell.name = name;
  cell.lattice_min = min;
  cell.cell_voxels = like.cell_voxels;
  cell.lods = like.lods;
  return cell;
}

}  // namespace

std::vector<SceneCell> lost_cells(const SceneHeader& scene, const std::vector<SceneCell>& cells) {
  std::vector<SceneCell> lost;
  std::map<StackColumn, std::int64_t> bases;
  std::map<StackColumn, bool> filled;
  std::int64_t low = cells.front().lattice_min[2], high = low;
  const std::int64_t edge = cells.front().cell_voxels;
  for (const SceneLoss& loss : scene.losses) {
    if (!loss.name.starts_with(cell_prefix)) continue;
    if (bases.empty()) {
      bases = stack_bases(cells);
      for (const SceneCell& cell : cells) {
        low = std::min(low, cell.lattice_min[2]);
        high = std::max(high, cell.lattice_min[2] + edge);
      }
    }
    const std::string name = loss.name.substr(cell_prefix.size());
    const auto place = place_of(name);
    if (!place)
      throw InputError({}, loss.name,
                       "the name of this missing cell does not state its position; bake the scene again");
    const StackColumn column{place->at[0], place->at[1]};
    const Vec3i64 corner{column.first * edge, column.second * edge, 0};
    if (const auto base = bases.find(column); base != bases.end())
      lost.push_back(placeholder(name, cells.front(), {corner[0], corner[1], base->second + place->at[2] * edge}));
    else if (!std::exchange(filled[column], true))
      for (std::int64_t z = low; z < high; z += edge)
        lost.push_back(placeholder(name, cells.front(), {corner[0], corner[1], z}));
  }
  return lost;
}

bool has_lost_cells(const SceneHeader& scene) {
  return std::ranges::any_of(scene.losses, [](const SceneLoss& loss) { return loss.name.starts_with(cell_prefix); });
}

}  // namespace gigabake
