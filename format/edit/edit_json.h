/// Edits as JSON: the members `edits` of a scene .json and of OUT/edits.json (docs/editing.md).
#pragma once

#include <functional>
#include <string>
#include <string_view>

#include "format/edit/edit.h"
#include "format/system/json/json_members.h"

namespace gigabake {

/// Max number of edits of a list.
inline constexpr std::size_t max_edits = 1 << 20;

/// A function that reads the mesh file at the member `path` of a shape, in the file's frame with z up.
using ShapeMeshReader = std::function<MeshShape(const JsonMembers& shape)>;

/// Returns the edits in the member `edits`; none if it is absent. Without a reader, the list itself must have the
/// positions of meshes.
/// Errors  UsageError with file and key: an edit has an unknown type, shape or member, or none; a shape is empty or
///         swapped; a polygon crosses itself; a number is out of range.
EditList edits_of(const JsonMembers& members, const ShapeMeshReader& reader = nullptr);

/// Returns one edit. Meshes list their positions.
/// Errors  InputError with file and key, for the reasons of edits_of().
Edit edit_of(const JsonMembers& edit);

/// Parses the text of to_json(). The edits get the file's name for messages.
/// Errors  UsageError like edits_of(), and if the text is not a JSON object with the member `edits` only.
EditList edits_from_json(const std::filesystem::path& file, std::string_view text);

/// Returns the list as a JSON object with the member `edits`, one edit per line.
/// Exact   Equal edits give equal text; edits_from_json() returns the same numbers.
std::string to_json(const EditList& edits);
/// Returns one edit as one line of JSON.
std::string to_json(const Edit& edit);

}  // namespace gigabake
