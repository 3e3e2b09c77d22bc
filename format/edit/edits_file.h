/// The file SCENE/edits.json, in which a bake's folder has the edits of its scene.
#pragma once

#include <filesystem>
#include <string>

#include "format/edit/scene_edits.h"

namespace gigabake {

/// Returns the list of edits that bakes into `out` apply after the edits of the source.
inline std::filesystem::path edits_file_of(const std::filesystem::path& out) { return out / "edits.json"; }

/// Returns the text of OUT/edits.json; empty if there is no file.
/// Errors  InputError: the file cannot be read.
std::string read_edits_file(const std::filesystem::path& out);

/// Returns the edits in a text of OUT/edits.json; none if the text is empty.
/// Errors  UsageError like scene_edits_from_json().
SceneEditList edits_of_file(const std::filesystem::path& out, const std::string& text);

}  // namespace gigabake
