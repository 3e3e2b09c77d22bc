#include "format/tile_hash.h"

#define XXH_INLINE_ALL
#include <memory>
#include <xxhash.h>

#include "format/content_container.h"
#include "format/error.h"

namespace gigabake {
namespace {

class Digest {
 public:
  Digest() : state_(XXH3_createState(), XXH3_freeState) { XXH3_128bits_reset(state_.get()); }
  void add(const void* data, std::size_t bytes) { XXH3_128bits_update(state_.get(), data, bytes); }
  void add_file(std::span<const std::uint8_t> bytes) {
    const std::uint64_t size = bytes.size();
    add(&size, sizeof size);
    add(bytes.data(), bytes.size());
  }
  Hash128 value() const {
    const XXH128_hash_t h = XXH3_128bits_digest(state_.get());
    return {h.low64, h.high64};
  }

 private:
  std::unique_ptr<XXH3_state_t, XXH_errorcode (*)(XXH3_state_t*)> state_;
};

/// The stamp is of the name as the tile writes it, the content of the file that resolve_uri() makes of it: where these
/// differ (a path through a folder that is not there), nobody can tell from a stamp what will be read.
StampedFile stamped_uri(const TileRef& tile, const std::string& uri, const std::filesystem::path& resolved) {
  StampedFile file = stamped(uri_path(uri), tile.path.parent_path() / uri_path(uri));
  if (stamp_of(resolved) != file.stamp) file.settled = false;
  return file;
}

void add_external_files(const TileRef& tile, const std::filesystem::path& root, const Json& gltf, const char* list,
                        Digest& digest, std::vector<StampedFile>& files) {
  const Json& items = get_array(tile.path, gltf, "", list);
  for (std::size_t i = 0; i < items.size(); ++i) {
    const std::string where = std::string(list) + "[" + std::to_string(i) + "]";
    const auto uri = get_text(tile.path, items[i], where, "uri");
    if (!uri || uri->starts_with("data:")) continue;
    const std::filesystem::path path = resolve_uri(root, tile.path, where + ".uri", *uri);
    files.push_back(stamped_uri(tile, *uri, path));
    std::error_code error;
    // What is missing is an error where it is needed; as part of the identity it is an empty file.
    digest.add_file(std::filesystem::is_regular_file(path, error) ? read_whole_file(path)
                                                                  : std::vector<std::uint8_t>());
  }
}

}  // namespace

TileIdentity identify_tile(const TileRef& tile, const std::filesystem::path& root) {
  TileIdentity out;
  out.files.push_back(stamped(tile.path.filename().string(), tile.path));
  const ContentContainer container = open_container(tile);
  Digest digest;
  digest.add_file(container.file);
  const Json gltf = parse_json(tile.path, container.json);
  add_external_files(tile, root, gltf, "buffers", digest, out.files);
  add_external_files(tile, root, gltf, "images", digest, out.files);
  digest.add(tile.scene_from_tile.m.data(), sizeof tile.scene_from_tile.m);
  digest.add(&tile.gltf_up, sizeof tile.gltf_up);
  out.hash = digest.value();
  return out;
}

Hash128 tile_hash(const TileRef& tile, const std::filesystem::path& root) { return identify_tile(tile, root).hash; }

std::filesystem::path path_of(const TileRef& tile, const StampedFile& file) {
  return tile.path.parent_path() / file.name;
}

}  // namespace gigabake
