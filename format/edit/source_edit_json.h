/// Edits of a source as JSON: the member `edits` of a source in a scene .json (docs/editing.md).
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "format/edit/source_edit.h"
#include "format/system/json/json_members.h"

namespace gigabake {

/// The permission to have the member `source`, which the caller reads.
enum class MayNameSource : std::uint8_t { no, yes };

/// Returns one edit.
/// Errors  InputError with file and key, for the reasons of source_edits_of().
SourceEdit source_edit_of(const JsonMembers& edit, MayNameSource naming);

/// Returns the edits in the member `edits`; none if it is absent.
/// Errors  UsageError with file and key: an unknown type or member, a polygon that crosses itself, or a number out of
///         range.
SourceEdits source_edits_of(const JsonMembers& source);

/// Returns the list as a JSON object with the member `edits`.
/// Exact   Equal edits give equal text; source_edits_from_json() returns the same numbers.
std::string to_json(const SourceEdits& edits);
/// Returns one edit as one line of JSON.
std::string to_json(const SourceEdit& edit);

/// Parses the text of to_json().
/// Errors  UsageError like source_edits_of(), and if the text is not a JSON object.
SourceEdits source_edits_from_json(const std::filesystem::path& file, std::string_view text);

}  // namespace gigabake
