/// Check of the glTF version.
#pragma once

#include <filesystem>

#include "format/source/source_file.h"

namespace gigabake {

/// Checks that the document is glTF 2.
/// Errors  InputError: glTF 1.0, with the command that converts it; another version than 2, or no version.
void expect_gltf_2(const std::filesystem::path& file, const Json& gltf);

/// Refuses a document or a container of version 1.0.
/// Errors  InputError, with the command that converts it.
[[noreturn]] void refuse_gltf_1(const std::filesystem::path& file);

}  // namespace gigabake
