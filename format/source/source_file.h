/// Reading of untrusted files: sizes, JSON and paths are checked before use.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "format/source/json/json_parse.h"
#include "format/system/read_file.h"

namespace gigabake {

/// Returns a member of a glTF object through JsonMembers (format/system/json/json_members.h); nullopt if it is absent.
/// `where` is the path of the object in the file.
/// Errors  InputError(file, where.key) like JsonMembers.
std::optional<std::uint64_t> get_index(const std::filesystem::path& file, const Json& object, const std::string& where,
                                       const char* key);
std::optional<double> get_number(const std::filesystem::path& file, const Json& object, const std::string& where,
                                 const char* key);
std::optional<std::string> get_text(const std::filesystem::path& file, const Json& object, const std::string& where,
                                    const char* key);
/// Returns exactly `count` finite numbers.
std::optional<std::vector<double>> get_numbers(const std::filesystem::path& file, const Json& object,
                                               const std::string& where, const char* key, std::size_t count);
/// Returns an array or object member; an empty array or object if it is absent.
const Json& get_array(const std::filesystem::path& file, const Json& object, const std::string& where, const char* key);
const Json& get_object(const std::filesystem::path& file, const Json& object, const std::string& where,
                       const char* key);

/// Returns `text` with each percent escape, such as "%41", replaced by the byte that it encodes.
std::string percent_decoded(std::string_view text);

/// Returns the path in `uri`: percent-decoded, without query and fragment. A backslash is invalid in a URI. It is
/// read as a slash, as in browsers, because Windows programs write it. "%5C" becomes a backslash in the name.
std::string uri_path(std::string_view uri);

/// Returns the path of the file that `uri` refers to. The URI is in the file `base`, and its uri_path() is relative to
/// that file. The result need not exist.
/// Errors  InputError(base, key): the URI has a scheme, its path is absolute, or the file is outside `root` after
///         symbolic links are followed.
std::filesystem::path resolve_uri(const std::filesystem::path& root, const std::filesystem::path& base,
                                  const std::string& key, std::string_view uri);

/// Resolves a path like resolve_uri(). A percent sign has no special meaning, because `name` is not a URI.
std::filesystem::path resolve_path(const std::filesystem::path& root, const std::filesystem::path& base,
                                   const std::string& key, const std::string& name);

/// Resolves a path in a scene .json like resolve_path(). A backslash separates folders unless a file with the backslash
/// in its name exists.
/// Errors  InputError like resolve_uri().
std::filesystem::path resolve_name(const std::filesystem::path& root, const std::filesystem::path& base,
                                   const std::string& key, const std::string& name);

/// Returns the lower-case extension: ".glb" for "A.GLB".
std::string lower_extension(const std::filesystem::path& path);

/// Returns `path` relative to `root`, '/' separated.
std::string name_in(const std::filesystem::path& root, const std::filesystem::path& path);

}  // namespace gigabake
