/// A folder of a tileset as one .3tz archive: a ZIP file with an index by which a file is found in a few reads.
#pragma once

#include <filesystem>

#include "lattice/progress.h"

namespace gigabake {

/// Packs the files below `folder`, sorted by path, into `archive`, which appears whole or not at all. A gzip file is
/// stored as what it packs, deflated.
/// Exact   The same bytes for the same files: no dates.
/// Errors  InputError: a file that cannot be read, is larger than a ZIP entry, disk full. Stopped.
void write_archive_3tz(const std::filesystem::path& folder, const std::filesystem::path& archive,
                       const Progress& progress);

}  // namespace gigabake
