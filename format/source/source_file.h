/// Reading files that nobody vouches for: sizes, JSON and paths are looked at before anything uses them.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "format/source/json_parse.h"
#include "format/system/read_file.h"

namespace gigabake {

/// A member of the asked type, or nothing where it is absent. An index is written without a fraction or an exponent:
/// every parser of ours must see the same number. Errors  InputError(file, where.key): another type, or a number that
/// is negative, fractional or too large for an index.
std::optional<std::uint64_t> get_index(const std::filesystem::path& file, const Json& object, const std::string& where,
                                       const char* key);
std::optional<double> get_number(const std::filesystem::path& file, const Json& object, const std::string& where,
                                 const char* key);
std::optional<std::string> get_text(const std::filesystem::path& file, const Json& object, const std::string& where,
                                    const char* key);
/// Exactly `count` finite numbers.
std::optional<std::vector<double>> get_numbers(const std::filesystem::path& file, const Json& object,
                                               const std::string& where, const char* key, std::size_t count);
/// An array or object member; an empty one of that kind where it is absent.
const Json& get_array(const std::filesystem::path& file, const Json& object, const std::string& where, const char* key);
const Json& get_object(const std::filesystem::path& file, const Json& object, const std::string& where,
                       const char* key);

/// Returns `text` with each "%41" as the byte that it means.
std::string percent_decoded(std::string_view text);

/// The path in `uri`: percent-decoded, query and fragment cut off. A backslash, which no URI may hold, separates
/// folders, as browsers have it and programs on Windows write it; "%5C" is one in a name.
std::string uri_path(std::string_view uri);

/// The file that `uri`, written in `base`, names by its uri_path().
/// Errors  InputError: a scheme other than a plain path, an absolute path, or a file (symbolic links followed) outside
///         `root`. The file need not exist.
std::filesystem::path resolve_uri(const std::filesystem::path& root, const std::filesystem::path& base,
                                  const std::string& key, std::string_view uri);

/// As resolve_uri(), of a path as other formats write it: without percent signs' meaning.
std::filesystem::path resolve_path(const std::filesystem::path& root, const std::filesystem::path& base,
                                   const std::string& key, const std::string& name);

/// ".glb" of "A.GLB".
std::string lower_extension(const std::filesystem::path& path);

/// `path` relative to `root`, '/' separated.
std::string name_in(const std::filesystem::path& root, const std::filesystem::path& path);

}  // namespace gigabake
