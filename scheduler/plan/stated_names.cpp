#include "scheduler/plan/stated_names.h"

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>

#include "core/base/error.h"
#include "format/source/classes/source_classes.h"
#include "format/source/levels/named_voxel_sizes.h"

namespace gigabake {
namespace {

/// The names that the tiles of one source have.
struct FoundNames {
  std::vector<bool> is_found;  ///< by number of the name
  bool is_complete = true;     ///< all tiles of the source were read
};

/// Checks the names of one member of TileRef. `numbers` is the member of TileScan with the numbers of found names.
template <class Stated>
void expect_names(const std::vector<TileScan>& scans, const SceneSources& sources,
                  std::shared_ptr<const Stated> TileRef::*member, std::vector<std::uint32_t> TileScan::*numbers) {
  std::map<const Stated*, FoundNames> found;
  for (const TileScan& scan : scans) {
    const Stated* stated = (sources.tiles.at(scan.tile).*member).get();
    if (stated == nullptr) continue;
    FoundNames& names = found[stated];
    names.is_found.resize(stated->names());
    names.is_complete = names.is_complete && scan.error.empty();
    for (const std::uint32_t name : scan.*numbers) names.is_found.at(name) = true;
  }
  for (const TileRef& tile : sources.tiles) {
    const Stated* stated = (tile.*member).get();
    if (stated == nullptr || !found[stated].is_complete) continue;
    const std::vector<bool>& is_found = found[stated].is_found;
    for (std::size_t name = 0; name < is_found.size(); ++name)
      if (!is_found[name]) stated->refuse_unknown(name);
  }
}

}  // namespace

void expect_stated_names(const std::vector<TileScan>& scans, const SceneSources& sources) {
  for (const TileScan& scan : scans)
    if (scan.is_refused) throw UsageError(scan.error);
  if (sources.area != nullptr) return;
  expect_names(scans, sources, &TileRef::classes, &TileScan::classified);
  expect_names(scans, sources, &TileRef::named_sizes, &TileScan::sized);
}

}  // namespace gigabake
