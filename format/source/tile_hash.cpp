#include "format/source/tile_hash.h"

#define XXH_INLINE_ALL
#include <algorithm>
#include <memory>
#include <set>
#include <xxhash.h>

#include "core/base/error.h"
#include "format/source/classes/source_classes.h"
#include "format/source/content/content_container.h"
#include "format/source/content/data_uri.h"
#include "format/source/gltf/version.h"
#include "format/source/levels/named_voxel_sizes.h"
#include "format/source/mesh/obj_read.h"
#include "format/source/mesh/ply_read.h"
#include "format/source/raster/dem.h"
#include "format/system/json/json_members.h"

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
  void add_file(const SourceBytes& bytes) {
    const std::uint64_t size = bytes.size();
    add(&size, sizeof size);
    bytes.for_each_block(read_block_bytes,
                         [this](std::span<const std::uint8_t> block) { add(block.data(), block.size()); });
  }
  Hash128 value() const {
    const XXH128_hash_t h = XXH3_128bits_digest(state_.get());
    return {h.low64, h.high64};
  }

 private:
  std::unique_ptr<XXH3_state_t, XXH_errorcode (*)(XXH3_state_t*)> state_;
};

/// A collector of the files that a tile refers to. It adds each file to the tile's hash and to the list of files.
class Dependencies {
 public:
  Dependencies(const TileRef& tile, const SourceFiles& files, Digest& digest, std::vector<StampedFile>& read)
      : tile_(tile), files_(files), digest_(digest), read_(read) {}

  /// Adds the file that a URI in the file `base` refers to. A missing file is hashed like an empty file; the reader of
  /// the tile reports the error. The stamp belongs to the unresolved path in the URI, the content to the path from
  /// resolve_uri(). If the stamps of the two paths differ, as for a path through a missing folder, the stamp is not
  /// settled.
  void add(const std::filesystem::path& base, const std::string& key, const std::string& uri) {
    const std::filesystem::path path = resolve_uri(files_.root(), base, key, uri);
    const std::filesystem::path written = base.parent_path() / uri_path(uri);
    StampedFile file = files_.stamp(base == tile_.path ? uri_path(uri) : written.string(), written);
    if (!files_.archive() && stamp_of(path) != file.stamp) file.settled = false;
    read_.push_back(std::move(file));
    digest_.add_file(files_.has(path) ? files_.open(path) : SourceBytes());
  }

  /// Adds a file by its absolute path. A missing file is hashed like an empty file, because it may exist at the next
  /// bake.
  void add_file(const std::filesystem::path& path) {
    read_.push_back(files_.stamp(path.string(), path));
    digest_.add_file(files_.has(path) ? files_.open(path) : SourceBytes());
  }

  /// Adds the files that the items of a list in a glTF document refer to. Ignores a URI that cannot be resolved,
  /// because the reader of the tile reports it.
  void add_list(const std::filesystem::path& base, const Json& gltf, const char* list) {
    const JsonMembers document(base, gltf);
    const Json& items = document.array(list);
    for (std::size_t i = 0; i < items.size(); ++i) {
      const JsonMembers item = document.element(list, items, i);
      const auto uri = item.find<std::string>("uri");
      if (!uri || is_data_uri(*uri)) continue;
      try {
        add(base, item.path_of("uri"), *uri);
      } catch (const InputError&) {
        continue;
      }
    }
  }

 private:
  const TileRef& tile_;
  const SourceFiles& files_;
  Digest& digest_;
  std::vector<StampedFile>& read_;
};

template <class T>
void add_values(const std::vector<T>& values, Digest& digest) {
  const std::uint64_t count = values.size();
  digest.add(&count, sizeof count);
  digest.add(values.data(), values.size() * sizeof(T));
}

/// Returns the identity of a tile of a raster. Hashes the mesh of the tile, so that pixels outside the tile have no
/// effect.
TileIdentity identify_dem(const TileRef& tile, const SourceFiles& files) {
  TileIdentity out;
  for (const std::filesystem::path& file : dem_files(*tile.dem)) {
    const std::filesystem::path whole = std::filesystem::absolute(file);
    out.files.push_back(files.stamp(whole.string(), whole));
  }
  const DemMesh mesh = read_dem(*tile.dem, true);
  Digest digest;
  add_values(mesh.primitive.position, digest);
  add_values(mesh.primitive.index, digest);
  for (const EncodedImage& image : mesh.images) digest.add_file(image.bytes);
  digest.add(tile.scene_from_tile.m.data(), sizeof tile.scene_from_tile.m);
  out.hash = digest.value();
  return out;
}

/// Returns the files that an OBJ, a PLY or an STL refers to.
std::vector<std::filesystem::path> dependencies_of(const TileRef& tile, const SourceFiles& files) {
  if (tile.kind == ContentKind::obj) return obj_dependencies(tile, files);
  return tile.kind == ContentKind::ply ? ply_dependencies(tile, files) : std::vector<std::filesystem::path>();
}

TileIdentity identify_plain_mesh(const TileRef& tile, const SourceFiles& files) {
  TileIdentity out;
  Digest digest;
  Dependencies dependencies(tile, files, digest, out.files);
  if (!files.has(tile.path)) files.open(tile.path);  // throws an error with the reason
  dependencies.add_file(tile.path);
  out.files[0].name = files.archive() ? out.files[0].name : tile.path.filename().string();
  for (const std::filesystem::path& file : dependencies_of(tile, files)) dependencies.add_file(file);
  digest.add(tile.scene_from_tile.m.data(), sizeof tile.scene_from_tile.m);
  digest.add(&tile.gltf_up, sizeof tile.gltf_up);
  if (tile.named_sizes) {
    const std::string levels = to_json(*tile.named_sizes);
    digest.add(levels.data(), levels.size());
  }
  out.hash = digest.value();
  return out;
}

/// Returns the names of the items of a list in a glTF document. An item without a name has the name "", as in
/// read_tile().
std::set<std::string> names_in(const Json& gltf, const char* list) {
  std::set<std::string> names;
  const auto items = gltf.find(list);
  if (items == gltf.end() || !items->is_array()) return names;
  for (const Json& item : *items) {
    const bool is_named = item.is_object() && item.contains("name") && item["name"].is_string();
    names.insert(is_named ? item["name"].get<std::string>() : std::string());
  }
  return names;
}

TileIdentity identify_content(const TileRef& tile, const std::filesystem::path& root) {
  TileIdentity out;
  const SourceFiles files = files_of(tile, root);
  if (tile.kind == ContentKind::dem) return identify_dem(tile, files);
  if (tile.kind == ContentKind::obj || tile.kind == ContentKind::ply || tile.kind == ContentKind::stl)
    return identify_plain_mesh(tile, files);
  out.files.push_back(files.stamp(tile.path.filename().string(), tile.path));
  const ContentContainer container = open_container(tile, files);
  Digest digest;
  Dependencies dependencies(tile, files, digest, out.files);
  digest.add_file(container.content);
  if (!container.model_uri.empty()) dependencies.add(tile.path, "glTF URI", container.model_uri);
  const Json gltf = parse_json(container.gltf_file, container.json.span());
  expect_gltf_2(container.gltf_file, gltf);
  dependencies.add_list(container.gltf_file, gltf, "buffers");
  dependencies.add_list(container.gltf_file, gltf, "images");
  digest.add(tile.scene_from_tile.m.data(), sizeof tile.scene_from_tile.m);
  digest.add(&tile.gltf_up, sizeof tile.gltf_up);
  if (container.is_instanced) digest.add(tile.world_from_tile.m.data(), sizeof tile.world_from_tile.m);
  if (tile.named_sizes) {
    // Levels of names that the file does not have are left out, so that a change of them does not concern the tile.
    const std::string levels = to_json(*tile.named_sizes, names_in(gltf, "materials"), names_in(gltf, "nodes"));
    digest.add(levels.data(), levels.size());
  }
  out.hash = digest.value();
  return out;
}

}  // namespace

TileIdentity identify_tile(const TileRef& tile, const std::filesystem::path& root) {
  TileIdentity out = identify_content(tile, root);
  if (!tile.classes) return out;
  const std::string classes = to_json(*tile.classes);
  Digest digest;
  digest.add(&out.hash, sizeof out.hash);
  digest.add(classes.data(), classes.size());
  out.hash = digest.value();
  return out;
}

Hash128 tile_hash(const TileRef& tile, const std::filesystem::path& root) { return identify_tile(tile, root).hash; }

std::filesystem::path path_of(const TileRef& tile, const StampedFile& file) {
  return tile.path.parent_path() / file.name;
}

bool are_unchanged(const TileRef& tile, std::span<const StampedFile> files) {
  return !files.empty() && std::all_of(files.begin(), files.end(), [&](const StampedFile& file) {
    return file.settled && stamp_of(path_of(tile, file)) == file.stamp;
  });
}

}  // namespace gigabake
