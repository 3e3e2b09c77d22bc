/// Check of the glTF version.
#pragma once

#include <filesystem>

#include "format/source/source_file.h"

namespace gigabake {

/// Checks that the document is glTF 2.
/// Errors  InputError: the version is missing or is not 2. For glTF 1.0 the message states the command that converts
///         the file.
void expect_gltf_2(const std::filesystem::path& file, const Json& gltf);

/// Refuses a document or a container of version 1.0.
/// Errors  InputError, always. The message states the command that converts the file.
[[noreturn]] void refuse_gltf_1(const std::filesystem::path& file);

}  // namespace gigabake
