/// A tileset's folder as one .3tz archive: a ZIP file with an index that locates a file in a few reads.
#pragma once

#include <filesystem>

#include "core/base/progress.h"

namespace gigabake {

/// Packs the files below `folder`, sorted by path, into `archive`, which appears atomically. A gzip file is stored as
/// its uncompressed content, deflated.
/// Exact   Same bytes for the same files: the archive has no dates.
/// Errors  InputError: a file cannot be read or is larger than a ZIP entry, or the disk is full. Stopped.
void write_archive_3tz(const std::filesystem::path& folder, const std::filesystem::path& archive,
                       const Progress& progress);

}  // namespace gigabake
