#include "format/source/tiles/pnts.h"

#include <cstring>

#include "core/base/pluralize.h"
#include "format/source/content/content_pieces.h"
#include "format/source/tiles/feature_table.h"

namespace gigabake {
namespace {

std::uint64_t points_in(const TileRef& tile, const SourceFiles& files) {
  constexpr std::size_t header_bytes = 28, json_bytes_at = 12;
  ContentPieces pieces(tile, files);
  const std::vector<std::uint8_t> header = pieces.read(0, header_bytes);
  if (header.size() != header_bytes) return 0;
  std::uint32_t json_bytes;  // of the feature table
  std::memcpy(&json_bytes, &header[json_bytes_at], sizeof json_bytes);
  const std::vector<std::uint8_t> json = pieces.read(header_bytes, json_bytes);
  return FeatureTable(tile.path, json, {}).count("POINTS_LENGTH").value_or(0);
}

}  // namespace

SkippedSource skipped_points(const TileRef& tile, const SourceFiles& files, const std::string& name) {
  SkippedSource out{name, "holds points, which have no surface", true};
  try {
    out.points = points_in(tile, files);
  } catch (const std::exception&) {  // points are not baked in any case
  }
  if (out.points != 0) out.reason = "holds " + pluralize(out.points, "point") + ", which have no surface";
  return out;
}

}  // namespace gigabake
