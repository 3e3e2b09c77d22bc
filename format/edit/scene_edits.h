/// The list of edits of a baked scene, of voxels and of sources: SCENE/edits.json (docs/editing.md).
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "format/edit/edit.h"
#include "format/edit/source_edit.h"

namespace gigabake {

/// An edit of one source of a scene .json, or of all sources.
struct NamedSourceEdit {
  SourceEdit edit;
  std::string source;  ///< text of its member `path` or `dem` in the scene .json; empty: all sources
};
using NamedSourceEdits = std::vector<NamedSourceEdit>;

using SceneEdit = std::variant<Edit, NamedSourceEdit>;
/// Edits in the order in which they were made. Edits of sources apply before all edits of voxels.
using SceneEditList = std::vector<SceneEdit>;

EditList voxel_edits(const SceneEditList& list);
NamedSourceEdits source_edits(const SceneEditList& list);

/// Returns the key of an edit in its file, such as "edits[3]".
const std::string& key_of(const SceneEdit& edit);

/// Parses the text of to_json(). The edits get the file's name for messages.
/// Errors  UsageError like edits_from_json() and source_edits_from_json().
SceneEditList scene_edits_from_json(const std::filesystem::path& file, std::string_view text);

/// Returns the list as a JSON object with the member `edits`, one edit per line. Equal edits give equal text.
std::string to_json(const SceneEditList& list);
/// Returns one edit as one line of JSON.
std::string to_json(const SceneEdit& edit);

/// Throws the error of a wrong edit: UsageError with the edit's file, its key and the message.
[[noreturn]] void refuse(const NamedSourceEdit& edit, const std::string& message);

}  // namespace gigabake
