#include "scheduler/plan/class_check.h"

#include <cstddef>
#include <map>

#include "core/base/error.h"
#include "format/source/classes/source_classes.h"

namespace gigabake {
namespace {

/// The names of materials that the tiles of one source have.
struct FoundNames {
  std::vector<bool> is_found;  ///< by index in SourceClasses::of_materials
  bool is_complete = true;     ///< all tiles of the source were read
};

}  // namespace

void expect_classes(const std::vector<TileScan>& scans, const SceneSources& sources) {
  std::map<const SourceClasses*, FoundNames> found;
  for (const TileScan& scan : scans) {
    if (scan.is_refused) throw UsageError(scan.error);
    const SourceClasses* classes = sources.tiles.at(scan.tile).classes.get();
    if (classes == nullptr) continue;
    FoundNames& names = found[classes];
    names.is_found.resize(classes->of_materials.size());
    names.is_complete = names.is_complete && scan.error.empty();
    for (const std::uint32_t name : scan.classified) names.is_found.at(name) = true;
  }
  if (sources.area != nullptr) return;
  for (const TileRef& tile : sources.tiles) {
    if (tile.classes == nullptr || !found[tile.classes.get()].is_complete) continue;
    const std::vector<bool>& is_found = found[tile.classes.get()].is_found;
    for (std::size_t name = 0; name < is_found.size(); ++name)
      if (!is_found[name])
        tile.classes->refuse("class_of_material", "no material of the source has the name " +
                                                      in_quotes(tile.classes->of_materials[name].name));
  }
}

}  // namespace gigabake
