/// Bytes that glTF and 3D Tiles refer to by a URI. The bytes are in the URI itself or in a file.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "format/source/source_files.h"

namespace gigabake {

/// Returns whether the scheme of the URI is "data", in upper or lower case.
bool is_data_uri(std::string_view uri);

/// Returns the bytes in a data URI. Ignores the media type and parameters: the bytes themselves show their format.
/// Errors  InputError(file, key): the URI has no comma, or its base64 has invalid characters.
/// Source  RFC 2397 (data URI); RFC 4648 (base64). Both alphabets of base64 are accepted, with and without padding.
std::vector<std::uint8_t> data_uri_bytes(const std::filesystem::path& file, const std::string& key,
                                         std::string_view uri);

/// Returns the bytes that a URI in the file `base` refers to.
/// Errors  InputError(base, key) like data_uri_bytes() and resolve_uri(). Also if the file does not exist; the message
///         has its path.
std::vector<std::uint8_t> uri_bytes(const SourceFiles& files, const std::filesystem::path& base, const std::string& key,
                                    const std::string& uri);

}  // namespace gigabake
