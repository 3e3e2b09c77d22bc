#include "format/source/folder_listing.h"

#include <algorithm>
#include <optional>
#include <set>
#include <string_view>

#include "core/base/error.h"
#include "core/base/pluralize.h"
#include "format/source/source_file.h"
#include "format/source/source_files.h"
#include "format/source/tiles/tileset_document.h"
#include "format/system/path_within.h"

namespace gigabake {
namespace {

using Path = std::filesystem::path;

void add_uris(const TilesetTile& tile, const Path& file, std::set<Path>& named) {
  for (const std::string& uri : tile.uris) named.insert((file.parent_path() / uri_path(uri)).lexically_normal());
  for (const TilesetTile& child : tile.children) add_uris(child, file, named);
}

/// Tilesets of a folder, recognized by their content.
class Tilesets {
 public:
  void add_if_tileset(const Path& file) {
    try {
      const TilesetDocument document = parse_tileset(file, SourceFiles(file.parent_path()).read_content(file));
      if (!document.root || !document.json.contains("asset")) return;
      found_.push_back(file.lexically_normal());
      add_uris(*document.root, file, named_);
    } catch (const InputError& e) {
      if (file.filename() == "tileset.json") throw;
      if (!fault_ && looks_like_tileset(file)) fault_ = e;  // other files are not tilesets
    }
  }

  /// Returns the tileset that no other tileset names; nullopt if the folder has no tileset.
  std::optional<Path> root(const Path& folder) const {
    std::vector<Path> roots;
    for (const Path& file : found_)
      if (!named_.contains(file)) roots.push_back(file);
    if (found_.empty() && fault_) throw *fault_;  // else all tiles, coarse and fine, would be baked
    if (roots.empty()) return found_.empty() ? std::nullopt : std::optional(found_.front());
    if (roots.size() > 1)
      throw InputError(folder, "",
                       "holds " + pluralize(roots.size(), "tileset") + ", " + name_in(folder, roots[0]) + " and " +
                           name_in(folder, roots[1]) + (roots.size() > 2 ? " among them" : "") +
                           "; name one, or list them in a scene .json");
    if (roots[0].parent_path() != (folder / roots[0].filename()).lexically_normal().parent_path())
      throw InputError(roots[0], "", "is a tileset inside the folder; name it, or list the sources in a scene .json");
    return roots[0];
  }

 private:
  /// Returns whether a file that is not valid JSON contains the names of a tileset's members.
  static bool looks_like_tileset(const Path& file) {
    std::vector<std::uint8_t> bytes;
    try {
      bytes = SourceFiles(file.parent_path()).read_content(file);
    } catch (const InputError&) {
      return false;
    }
    const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    const auto has = [&](std::string_view name) { return text.find(name) != text.npos; };
    return has("\"root\"") && has("\"asset\"") && has("\"boundingVolume\"");
  }

  std::vector<Path> found_;
  std::set<Path> named_;
  std::optional<InputError> fault_;  ///< the reason why a tileset cannot be read
};

class Lister {
 public:
  Lister(const Path& folder, const std::function<bool(const Path&)>& is_wanted)
      : folder_(folder), root_(std::filesystem::weakly_canonical(folder)), is_wanted_(is_wanted) {}

  void add(const std::filesystem::directory_entry& entry) {
    std::error_code error;
    const bool is_json = lower_extension(entry.path()) == ".json";
    if (entry.is_symlink(error)) {
      const bool is_folder = entry.is_directory(error);
      if (is_folder || is_json || is_wanted_(entry.path())) add_link(entry.path(), is_folder);
    } else if (entry.is_regular_file(error)) {
      if (is_json) json_.push_back(entry.path());
      if (is_wanted_(entry.path())) files_.push_back(entry.path());
    }
  }

  FolderListing take() {
    FolderListing out;
    std::sort(json_.begin(), json_.end());
    Tilesets tilesets;
    for (const Path& file : json_) tilesets.add_if_tileset(file);
    out.tileset = tilesets.root(folder_);
    out.files = unique_files();
    if (left_out_ != 0)
      out.note = pluralize(left_out_, "symbolic link") +
                 " not followed, since they lead out of the folder or to no file: " + example_;
    return out;
  }

 private:
  /// Adds a link to a file inside the root. Counts a link out of the root or to no file. Skips a link to a folder
  /// inside the root, because that folder is listed itself.
  void add_link(const Path& link, bool is_folder) {
    std::error_code error;
    const Path target = std::filesystem::canonical(link, error);
    if (error || !is_within(root_, target)) {
      if (left_out_++ == 0 || name_in_folder(link) < example_) example_ = name_in_folder(link);
    } else if (!is_folder) {
      (lower_extension(link) == ".json" ? json_ : links_).push_back(link);
    }
  }

  std::string name_in_folder(const Path& path) const { return path.lexically_relative(folder_).generic_string(); }

  /// Returns the files without duplicates, because a link may lead to a file that is listed itself.
  std::vector<Path> unique_files() {
    std::sort(links_.begin(), links_.end());
    std::set<Path> targets;
    for (const Path& file : files_) targets.insert(std::filesystem::weakly_canonical(file));
    for (const Path& link : links_)
      if (targets.insert(std::filesystem::weakly_canonical(link)).second) files_.push_back(link);
    std::sort(files_.begin(), files_.end());
    return std::move(files_);
  }

  const Path& folder_;
  Path root_;
  const std::function<bool(const Path&)>& is_wanted_;
  std::vector<Path> files_, links_, json_;
  std::uint64_t left_out_ = 0;
  std::string example_;
};

}  // namespace

FolderListing list_folder(const Path& folder, const std::function<bool(const Path&)>& is_wanted,
                          const Progress& progress) {
  progress.step("listing the folder", 0, "name");
  Lister lister(folder, is_wanted);
  std::error_code error;
  const auto flags = std::filesystem::directory_options::none;
  for (std::filesystem::recursive_directory_iterator it(folder, flags, error), end; !error && it != end;
       it.increment(error)) {
    progress.advance();
    lister.add(*it);
  }
  if (error) throw InputError(folder, "", "cannot be listed: " + error.message());
  return lister.take();
}

}  // namespace gigabake
