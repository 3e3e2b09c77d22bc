/// Listing of the source files in a folder.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/base/progress.h"

namespace gigabake {

struct FolderListing {
  std::vector<std::filesystem::path> files;      ///< the accepted ones, sorted, each file once
  std::optional<std::filesystem::path> tileset;  ///< of the folder; any file name
  std::string note = {};                         ///< omitted files: a count and an example
};

/// Lists the files below a folder that `is_wanted` accepts by their names. Symbolic links to files inside the folder
/// are followed; others are counted in the note. A .json is a tileset if its content is that of a tileset. If the
/// folder itself has several, the tileset that no other one names counts.
/// Errors  InputError: the folder cannot be listed, has several tilesets, or has tilesets only in folders below. A list
///         of files would lose the transforms and levels of detail of their tiles. Stopped.
FolderListing list_folder(const std::filesystem::path& folder,
                          const std::function<bool(const std::filesystem::path&)>& is_wanted, const Progress& progress);

}  // namespace gigabake
