/// Which files of a folder are its sources.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "lattice/progress.h"

namespace gigabake {

struct FolderListing {
  std::vector<std::filesystem::path> files;      ///< that are wanted, sorted, each file once
  std::optional<std::filesystem::path> tileset;  ///< of the folder, by whatever name
  std::string note = {};                         ///< what was left out: a count and an example
};

/// Lists the files below a folder that `is_wanted` accepts by their names. Symbolic links to files inside the folder
/// are followed; others are counted in the note. A .json is a tileset if it holds one; of several in the folder itself
/// that one counts which no other names.
/// Errors  InputError: the folder cannot be listed, has several tilesets, or has tilesets only in folders below. Their
///         tiles have places and several levels of detail, which a list of files does not know. Stopped.
FolderListing list_folder(const std::filesystem::path& folder,
                          const std::function<bool(const std::filesystem::path&)>& is_wanted, const Progress& progress);

}  // namespace gigabake
