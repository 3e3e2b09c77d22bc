#include "cluster/bake/empty_scene.h"

#include <fmt/format.h>
#include <string>

#include "core/base/pluralize.h"
#include "core/base/quote.h"
#include "format/source/invisible_material.h"

namespace gigabake {
namespace {

/// Returns the cause of an empty scene. Reads tiles until it finds an invisible material.
std::string cause_of(const SceneSources& sources) {
  for (const TileRef& tile : sources.tiles) {
    try {
      if (const auto name = invisible_material(tile, sources.root))
        return fmt::format("material {} of {} has alpha 0; make it opaque", *name, short_path(tile.name));
    } catch (const InputError&) {
      // An unreadable tile is skipped: another tile may have an invisible material.
    }
  }
  return "textures or vertex colours have alpha 0; make them opaque";
}

}  // namespace

InputError nothing_visible(const std::filesystem::path& source, const SceneSources& sources, const BakePlan& plan,
                           std::string_view consequence) {
  const std::size_t cells = plan.cells();
  return {
      source, "",
      fmt::format("nothing is visible, so {}: {} empty; {}", consequence,
                  cells == 1 ? "the cell is" : fmt::format("all {} are", pluralize(cells, "cell")), cause_of(sources))};
}

}  // namespace gigabake
