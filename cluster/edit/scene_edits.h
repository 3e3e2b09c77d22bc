/// Files in a bake's folder OUT from which a later command bakes the scene again with other edits.
#pragma once

#include <filesystem>
#include <string>

#include "format/edit/scene_edits.h"

namespace gigabake {

/// Returns the list of edits that bakes into `out` apply after the edits of the source.
inline std::filesystem::path edits_file_of(const std::filesystem::path& out) { return out / "edits.json"; }

/// Returns the file with the source and options of the published bake, which the caller of bake() defines.
inline std::filesystem::path source_file_of(const std::filesystem::path& out) { return out / "source.json"; }

/// A change of OUT/edits.json. Both are texts of the file; empty means no file.
struct EditsChange {
  std::string before, after;
};

/// Returns the text of OUT/edits.json; empty if there is no file.
/// Errors  InputError: the file cannot be read.
std::string read_edits_file(const std::filesystem::path& out);

/// Returns the edits in a text of OUT/edits.json; none if the text is empty.
/// Errors  UsageError like scene_edits_from_json().
SceneEditList edits_of_file(const std::filesystem::path& out, const std::string& text);

/// Writes OUT/edits.json, or removes it if `text` is empty.
/// Errors  InputError.
void write_edits_file(const std::filesystem::path& out, const std::string& text);

}  // namespace gigabake
