#include "format/source/tiles/tileset_inclusions.h"

#include <bit>
#include <set>

#include "core/base/error.h"
#include "format/source/source_file.h"

namespace gigabake {
namespace {

constexpr double max_visits = 1 << 18;

bool may_be_tileset(const std::filesystem::path& file) {
  static const std::set<std::string> models{".glb", ".gltf", ".b3dm", ".i3dm", ".cmpt", ".pnts"};
  return !models.contains(lower_extension(file));
}

}  // namespace

void TilesetInclusions::read(const std::filesystem::path& file, const std::vector<std::string>& uris) {
  if (first_.empty()) first_ = file.string();
  const auto [at, is_new] = tilesets_.try_emplace(file.string());
  if (!is_new) {
    if (std::has_single_bit(++again_)) expect_few();
    return;
  }
  for (const std::string& uri : uris) {
    const std::filesystem::path included = uri_path(uri);
    if (may_be_tileset(included))
      at->second.included.push_back((file.parent_path() / included).lexically_normal().string());
  }
}

void TilesetInclusions::expect_few() const {
  std::map<std::string, Tileset> tilesets = tilesets_;
  const double visits = visits_of(first_, tilesets);
  if (visits > max_visits)
    throw InputError(first_, "",
                     "external tilesets include each other too often: more than 2^18 would have to be read");
}

double TilesetInclusions::visits_of(const std::string& file, std::map<std::string, Tileset>& tilesets) const {
  const auto at = tilesets.find(file);
  if (at == tilesets.end()) return 0;
  Tileset& tileset = at->second;
  if (tileset.is_open) throw InputError(file, "root", "the tileset includes itself");
  if (tileset.visits != 0) return tileset.visits;
  tileset.is_open = true;
  double visits = 1;
  for (const std::string& included : tileset.included) visits += visits_of(included, tilesets);
  tileset.is_open = false;
  return tileset.visits = visits;
}

}  // namespace gigabake
