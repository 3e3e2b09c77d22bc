/// A tileset's folder as one .3tz archive: a ZIP file with an index that locates a file in a few reads.
#pragma once

#include <filesystem>

#include "core/base/progress.h"

namespace gigabake {

/// Packs the files below `folder` into `archive`, sorted by path. The archive appears atomically. A gzip file becomes a
/// deflated entry whose content is the unpacked file.
/// Exact   Same bytes for the same files: the archive has no dates.
/// Errors  InputError: a file cannot be read or is too large for a ZIP entry, or the disk is full. Stopped: the export
///         was cancelled.
void write_archive_3tz(const std::filesystem::path& folder, const std::filesystem::path& archive,
                       const Progress& progress);

}  // namespace gigabake
