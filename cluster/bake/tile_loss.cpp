#include "cluster/bake/tile_loss.h"

#include <string_view>

namespace gigabake {
namespace {

constexpr std::string_view tile_prefix = "tile ";

/// Returns "b.tif" for "a/b.tif[3]".
std::string file_name_of(const std::string& tile) {
  const std::string name = tile.substr(tile.find_last_of('/') + 1);
  return name.ends_with(']') ? name.substr(0, name.rfind('[')) : name;
}

}  // namespace

std::string reason_without_tile(const SceneLoss& loss) {
  const std::size_t end = loss.reason.find(": ");
  if (end == std::string::npos || !loss.name.starts_with(tile_prefix)) return "";
  const std::string file = file_name_of(loss.reason.substr(0, end));
  return file == file_name_of(loss.name.substr(tile_prefix.size())) ? loss.reason.substr(end + 2) : "";
}

}  // namespace gigabake
