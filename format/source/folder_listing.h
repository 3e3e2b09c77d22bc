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
  std::vector<std::filesystem::path> files;      ///< accepted files, sorted and without duplicates
  std::optional<std::filesystem::path> tileset;  ///< tileset in the folder, with any file name
  std::string note = {};                         ///< omitted files: a count and an example
};

/// Lists the files below a folder that `is_wanted` accepts by their names. Symbolic links to files inside the folder
/// are followed; links out of the folder are counted in the note. A .json file is a tileset if it has the content of a
/// tileset. If there are several tilesets, the result is the tileset that no other tileset names.
/// Errors  InputError: the folder cannot be listed, has several tilesets that no other tileset names, or has its
///         tileset in a subfolder. Stopped: the caller cancelled the step.
FolderListing list_folder(const std::filesystem::path& folder,
                          const std::function<bool(const std::filesystem::path&)>& is_wanted, const Progress& progress);

}  // namespace gigabake
