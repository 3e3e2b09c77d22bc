#include "format/source/tiles/tileset.h"

#include <algorithm>
#include <iterator>
#include <type_traits>

#include "core/base/error.h"
#include "core/base/memory_limit.h"
#include "core/base/quote.h"
#include "format/source/content/composite.h"
#include "format/source/loss_reason.h"
#include "format/source/tiles/implicit_tiling.h"
#include "format/source/tiles/pnts.h"
#include "format/source/tiles/tileset_anchor.h"
#include "format/source/tiles/tileset_head.h"
#include "format/source/tiles/tileset_inclusions.h"

namespace gigabake {
namespace {

using Path = std::filesystem::path;

constexpr std::size_t deepest_external = 32;
constexpr std::uint64_t max_tileset_tiles = std::uint64_t(1) << 24;
constexpr std::size_t max_missing_contents = std::size_t(1) << 16;
/// Max bytes of external tilesets. Each counts as at least 16 KiB: their number can double at each inclusion.
constexpr std::uint64_t max_external_bytes = std::uint64_t(1) << 32, min_external_bytes = std::uint64_t(1) << 14;

constexpr std::uint64_t content_bytes = sizeof(TilesetContent) + sizeof(TileRef) + 64;

/// State that a tile inherits from its parent.
struct Context {
  SourceFiles files;
  Path file;
  UpAxis gltf_up = UpAxis::y;
  Affine<World, World> world_from_parent = {};
  Refine refine = Refine::replace;
};

/// The finest contents of a tile and of all tiles below it.
struct Subtree {
  std::vector<TilesetContent> contents;
  bool is_missing_some = false;  ///< a finest content is missing and no coarser content replaces it
  bool has_outside = false;      ///< some finest contents lie outside the area and were not opened
};

class Reader {
 public:
  Reader(Path root, const MakeVolumeFilter& make_filter, Tileset& out, const Progress& progress)
      : root_(std::move(root)), make_filter_(make_filter), out_(out), progress_(progress), memory_(root_) {}

  /// Reads a document that check_tileset_head() has accepted.
  Subtree read_document(const Path& file, const TilesetDocument& document, Context context) {
    std::error_code error;
    const Path canonical = std::filesystem::weakly_canonical(file, error);
    if (std::find(open_files_.begin(), open_files_.end(), canonical) != open_files_.end())
      throw InputError(file, "root", "the tileset includes itself");
    if (open_files_.size() == deepest_external) throw InputError(file, "root", "external tilesets nest deeper than 32");
    context.file = file;
    context.gltf_up = tileset_up_axis(JsonMembers(file, document.json).members("asset"));
    if (open_files_.empty()) {
      find_anchor(document.json["root"], context);
      if (make_filter_) filter_ = make_filter_(out_.anchor);
    }
    open_files_.push_back(canonical);
    inclusions_.read(canonical, uris_below(*document.root));
    Subtree found = read_tile(*document.root, "root", context);
    open_files_.pop_back();
    return found;
  }

 private:
  /// Finds the anchor. A malformed volume is reported and is no anchor; the place then follows from the content.
  void find_anchor(const Json& root, const Context& here) {
    try {
      out_.anchor = tileset_anchor(here.file, root);
    } catch (const InputError& e) {
      skip(here, "root", e.what(), true);
    }
  }

  Subtree read_tile(const TilesetTile& tile, const std::string& where, const Context& parent) {
    count_tile(parent.file, where);
    if (tile.fault) {
      skip(parent, where, *tile.fault, false);
      return {{}, true};
    }
    Context here = parent;
    if (tile.world_from_tile) here.world_from_parent = parent.world_from_parent * *tile.world_from_tile;
    here.refine = tile.refine.value_or(parent.refine);
    if (is_outside(tile.volume.get(), here)) return outside(contents_below(tile));
    Subtree finer;
    for (std::size_t i = 0; i < tile.children.size(); ++i)
      join(finer, read_tile(tile.children[i], where + ".children[" + std::to_string(i) + "]", here));
    finer.is_missing_some |= tile.bad_children != 0;
    if (tile.bad_children != 0) skip(here, where + ".children", "expected tiles, which are JSON objects", false);
    if (tile.implicit) {
      join(finer, read_subtree({*tile.implicit, tile.uris, where, here, tile.volume.get()}, {}));
      return finer;
    }
    return with_own_content(tile.uris, where, here, std::move(finer));
  }

  /// An implicit root tile. The URIs of its contents are templates.
  struct Implicit {
    ImplicitTiling tiling;
    std::vector<std::string> uris;
    std::string where;
    Context here;
    const BoundingVolume* volume;  ///< null: unknown
  };

  bool is_outside(const BoundingVolume* volume, const Context& here) const {
    return filter_ && volume != nullptr && !filter_->may_overlap(*volume, here.world_from_parent);
  }

  /// Returns the result for a tile outside the area, whose contents are not opened.
  Subtree outside(std::uint64_t contents) {
    out_.outside += contents;
    return {{}, false, contents != 0};
  }

  bool is_outside(const Implicit& implicit, const TileCoordinates& place) const {
    if (!filter_ || implicit.volume == nullptr) return false;
    const BoundingVolume volume = volume_of(*implicit.volume, implicit.tiling.is_octree, place);
    return is_outside(&volume, implicit.here);
  }

  /// Reads the subtree's root and all tiles below it. `place` has the coordinates of the root in the whole tileset.
  Subtree read_subtree(const Implicit& implicit, const TileCoordinates& place) {
    if (is_outside(implicit, place)) return outside(1);
    const std::string key = implicit.where + ".implicitTiling.subtrees.uri";
    const SourceFiles& files = implicit.here.files;
    const std::string uri = filled_template(implicit.tiling.subtrees_uri, place);
    const std::optional<Path> path = existing(uri, key, implicit.here);
    if (!path) return {{}, true};
    const auto available = or_missing(
        implicit.here, key, [&] { return SubtreeAvailability(files, *path, implicit.tiling, implicit.uris.size()); });
    if (!available || !available->tile(0)) return {{}, !available};
    return read_implicit_tile(implicit, *available, place, {});
  }

  /// Reads an implicit tile and all tiles below it. `place` has its coordinates in the whole tileset, `local` has its
  /// coordinates relative to the subtree's root.
  Subtree read_implicit_tile(const Implicit& implicit, const SubtreeAvailability& available,
                             const TileCoordinates& place, const TileCoordinates& local) {
    const ImplicitTiling& tiling = implicit.tiling;
    count_tile(implicit.here.file, implicit.where);
    if (is_outside(implicit, place)) return outside(available.contents_below(tiling, local));
    Subtree finer;
    const bool has_children = place.level + 1 < tiling.available_levels;
    for (int child = 0; has_children && child < tiling.children(); ++child) {
      const TileCoordinates next = local.child(child), next_place = place.child(child);
      if (next.level < tiling.subtree_levels) {
        if (available.tile(tiling.index_in_subtree(next)))
          join(finer, read_implicit_tile(implicit, available, next_place, next));
      } else if (available.child_subtree(tiling.index_in_level(next))) {
        join(finer, read_subtree(implicit, next_place));
      }
    }
    std::vector<std::string> uris;
    for (std::size_t i = 0; i < implicit.uris.size(); ++i)
      if (available.content(i, tiling.index_in_subtree(local)))
        uris.push_back(filled_template(implicit.uris[i], place));
    return with_own_content(uris, implicit.where, implicit.here, std::move(finer));
  }

  void count_tile(const Path& file, const std::string& where) {
    progress_.advance();
    if (++tiles_ > max_tileset_tiles) throw InputError(file, where, "the tileset has more than 2^24 tiles");
  }

  Subtree with_own_content(const std::vector<std::string>& uris, const std::string& where, const Context& here,
                           Subtree finer) {
    const bool is_leaf = finer.contents.empty() && !finer.is_missing_some && !finer.has_outside;
    if (here.refine == Refine::replace && !is_leaf && !finer.is_missing_some) {
      join(finer, external_only(uris, where, here));
      return finer;
    }
    const std::size_t listed = out_.skipped.size();
    Subtree own;
    for (const std::string& uri : uris) join(own, read_content(uri, where, here));
    if (here.refine == Refine::add) {
      join(own, std::move(finer));
      own.is_missing_some = false;
      return own;
    }
    if (is_leaf) return own;
    if (!own.contents.empty() && !own.is_missing_some) return own;  // replaces the whole subtree
    out_.skipped.resize(listed);                                    // own content is unused: removes its faults
    finer.is_missing_some = true;
    return finer;
  }

  /// Reads the external tilesets among the tile's contents. External tilesets count as children even if the tile has
  /// finer content. A missing file is ignored, because finer content may replace it.
  Subtree external_only(const std::vector<std::string>& uris, const std::string& where, const Context& here) {
    Subtree found;
    for (const std::string& uri : uris) {
      const std::string key = where + ".content.uri";
      const std::optional<Path> path = found_quietly(uri, key, here);
      if (!path) continue;
      const ContentMagic magic = content_magic(here.files.content_head(*path, 4));
      if (magic == ContentMagic::zip) join(found, read_archive(*path, key, here));
      if (magic == ContentMagic::json) join(found, read_external(*path, here.files, key, here).value_or(Subtree()));
    }
    return found;
  }

  /// Returns the resolved path. Caches the last path: many tiles may share a path, and resolving needs system calls.
  const Path& resolved(const std::string& uri, const std::string& key, const Context& here) {
    if (last_.uri != uri || last_.base != here.file || last_.path.empty())
      last_ = {uri, here.file, resolve_uri(here.files.root(), here.file, key, uri)};
    return last_.path;
  }

  /// Returns the file that a URI names; nullopt if it cannot be used.
  std::optional<Path> found_quietly(const std::string& uri, const std::string& key, const Context& here) {
    try {
      const Path path = resolved(uri, key, here);
      return here.files.has(path) ? std::optional(path) : std::nullopt;
    } catch (const InputError&) {
      return std::nullopt;
    }
  }

  /// Returns the file that a URI names. Lists a missing file or an unresolvable URI as skipped and returns nullopt.
  std::optional<Path> existing(const std::string& uri, const std::string& key, const Context& here) {
    const auto path = or_missing(here, key, [&] { return resolved(uri, key, here); });
    if (path && here.files.has(*path)) return *path;
    if (path) skip(here, key, in_quotes(uri) + " is missing", false);
    return std::nullopt;
  }

  Subtree read_content(const std::string& uri, const std::string& where, const Context& here) {
    const std::string key = where + ".content.uri";
    if (uri.empty()) {  // an empty URI names no surface, so the content of an ancestor need not replace it
      skip(here, key, "is empty or missing", false);
      return {};
    }
    const std::optional<Path> path = existing(uri, key, here);
    if (!path) return {{}, true};
    const auto head = or_missing(here, key, [&] { return here.files.content_head(*path, 4); });
    if (!head) return {{}, true};
    const ContentMagic magic = content_magic(*head);
    if (magic == ContentMagic::zip) return read_archive(*path, key, here);
    if (magic == ContentMagic::composite) return read_composite(*path, uri, key, here);
    if (magic == ContentMagic::json)
      if (auto external = read_external(*path, here.files, key, here)) return std::move(*external);
    return read_model({*path, {}, here.gltf_up, here.world_from_parent, {}, "", here.files.archive()}, magic,
                      in_quotes(uri), key, here);
  }

  /// Reads a content that is no tileset and no composite. `name` is the URI in quotes, for messages.
  Subtree read_model(TilesetContent content, ContentMagic magic, const std::string& name, const std::string& key,
                     const Context& here) {
    memory_.add(content_bytes + 2 * content.path.native().size(), key, "the tiles of the tileset");
    switch (magic) {
      case ContentMagic::glb:
        content.kind = ContentKind::glb;
        return {{std::move(content)}, false};
      case ContentMagic::b3dm:
        content.kind = ContentKind::b3dm;
        return {{std::move(content)}, false};
      case ContentMagic::i3dm:
        content.kind = ContentKind::i3dm;
        return {{std::move(content)}, false};
      case ContentMagic::json:
        content.kind = ContentKind::gltf;
        return {{std::move(content)}, false};
      case ContentMagic::points:
        skip_points(content, name, key, here);
        return {};
      default:
        skip(here, key, name + " is neither glTF nor a tile of 3D Tiles", false);
        return {{}, true};
    }
  }

  Subtree read_composite(const Path& path, const std::string& uri, const std::string& key, const Context& here) {
    const auto parts = or_missing(here, key, [&] { return parts_of_composite(path, here.files.read_content(path)); });
    if (!parts) return {{}, true};
    Subtree found;
    for (const CompositePart& part : *parts)
      join(found,
           read_model({path, {}, here.gltf_up, here.world_from_parent, part.range, part.name, here.files.archive()},
                      part.magic, in_quotes(uri) + part.name, key, here));
    return found;
  }

  /// Returns the result of `read`. If `read` fails, lists the content as skipped and returns nullopt.
  template <class Read>
  std::optional<std::invoke_result_t<Read>> or_missing(const Context& here, const std::string& key, const Read& read) {
    try {
      return read();
    } catch (const InputError& e) {
      skip(here, key, e.what(), false);
      return std::nullopt;
    }
  }

  /// Reads the tileset.json of an archive that a tile names as its content.
  Subtree read_archive(const Path& path, const std::string& key, const Context& here) {
    const auto files = or_missing(here, key, [&] {
      if (here.files.archive()) throw InputError(path, "", "is an archive in an archive; unpack it");
      return SourceFiles(std::make_shared<const Archive>(path));
    });
    if (!files) return {{}, true};
    const auto found = read_external(path / "tileset.json", *files, key, here);
    if (found) return *found;
    skip(here, key, in_quotes(path.filename().string()) + " holds no tileset", false);
    return {{}, true};
  }

  /// Returns the contents of an external tileset; nullopt if the file is another JSON. A tileset that cannot be read is
  /// listed as skipped, and the result is marked as incomplete.
  std::optional<Subtree> read_external(const Path& path, const SourceFiles& files, const std::string& key,
                                       const Context& here) {
    const auto document = or_missing(here, key, [&] {
      TilesetDocument read = read_json(files, path);
      if (read.root) check_tileset_head(path, read);
      return read;
    });
    if (external_bytes_ > max_external_bytes)
      throw InputError(path, "", "external tilesets include each other too often: over 4 GiB, or over 2^18 files");
    if (!document) return Subtree{{}, true};
    if (!document->root) return std::nullopt;
    Context inside = here;
    inside.files = files;
    return read_document(path, *document, inside);
  }

  TilesetDocument read_json(const SourceFiles& files, const Path& path) {
    const std::vector<std::uint8_t> text = files.read_content(path);
    external_bytes_ += std::max<std::uint64_t>(text.size(), min_external_bytes);
    return parse_tileset(path, text, progress_, filter_ ? TileMembers::all : TileMembers::without_volumes);
  }

  static void join(Subtree& to, Subtree from) {
    if (to.contents.empty())
      to.contents = std::move(from.contents);
    else
      to.contents.insert(to.contents.end(), from.contents.begin(), from.contents.end());
    to.is_missing_some |= from.is_missing_some;
    to.has_outside |= from.has_outside;
  }

  void skip_points(const TilesetContent& content, const std::string& name, const std::string& key,
                   const Context& here) {
    TileRef tile;
    tile.path = content.path;
    tile.range = content.range;
    tile.archive = content.archive;
    const SkippedSource points = skipped_points(tile, here.files, name);
    skip(here, key, short_path(name) + " " + points.reason, true);
    out_.skipped.back().points = points.points;
  }

  void skip(const Context& here, const std::string& key, const std::string& reason, bool informative) {
    if (out_.skipped.size() == max_missing_contents)
      throw InputError(here.file, key, "more than 2^16 contents are missing or cannot be read; is the set complete?");
    const std::string cause = reason_without_place(reason, here.file, key);
    out_.skipped.push_back({name_in(root_, here.file) + ": " + key, cause, informative});
  }

  Path root_;  ///< names of skipped contents are relative to this folder
  const MakeVolumeFilter& make_filter_;
  std::optional<VolumeFilter> filter_;  ///< nullopt without an area
  Tileset& out_;
  const Progress& progress_;
  TilesetInclusions inclusions_;
  struct {
    std::string uri;
    Path base, path;
  } last_;                        ///< last resolved URI
  std::vector<Path> open_files_;  ///< from the first tileset to the current tileset
  std::uint64_t tiles_ = 0, external_bytes_ = 0;
  MemoryClaim memory_;
};

}  // namespace

Tileset open_tileset(const SourceFiles& files, const std::filesystem::path& file, const TilesetDocument& document,
                     const MakeVolumeFilter& make_filter, const Progress& progress) {
  progress.step("reading the tileset", 0, "tile");
  Tileset tileset;
  check_tileset_head(file, document);
  tileset.contents =
      Reader(files.root(), make_filter, tileset, progress).read_document(file, document, {files, file}).contents;
  return tileset;
}

}  // namespace gigabake
