/// Bytes that glTF and 3D Tiles refer to by a URI: in the URI itself, or in a file.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "format/source/source_files.h"

namespace gigabake {

/// Returns whether the URI holds its bytes: its scheme is "data", in any case.
bool is_data_uri(std::string_view uri);

/// Returns the bytes in a data URI. Ignores the media type and parameters: the bytes themselves show their format.
/// Errors  InputError(file, key): no comma, or invalid characters in base64.
/// Source  RFC 2397; RFC 4648, with either alphabet, and also without padding.
std::vector<std::uint8_t> data_uri_bytes(const std::filesystem::path& file, const std::string& key,
                                         std::string_view uri);

/// Returns the bytes that a URI in the file `base` refers to.
/// Errors  InputError(base, key): as data_uri_bytes() and resolve_uri(); no such file, which is named with its path.
std::vector<std::uint8_t> uri_bytes(const SourceFiles& files, const std::filesystem::path& base, const std::string& key,
                                    const std::string& uri);

}  // namespace gigabake
