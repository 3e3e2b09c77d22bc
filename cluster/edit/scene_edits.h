/// Files in a bake's folder OUT from which a later command bakes the scene again with other edits.
#pragma once

#include <filesystem>
#include <string>

#include "format/edit/edits_file.h"

namespace gigabake {

/// Returns the file with the source and options of the published bake, which the caller of bake() defines.
inline std::filesystem::path source_file_of(const std::filesystem::path& out) { return out / "source.json"; }

/// A change of OUT/edits.json. Both are texts of the file; empty means no file.
struct EditsChange {
  std::string before, after;
};

/// Writes OUT/edits.json, or removes it if `text` is empty.
/// Errors  InputError.
void write_edits_file(const std::filesystem::path& out, const std::string& text);

}  // namespace gigabake
