/// Which glTF is it?
#pragma once

#include <filesystem>

#include "format/source/source_file.h"

namespace gigabake {

/// Errors  InputError: glTF 1.0, with what converts it; another version than 2, or none.
void expect_gltf_2(const std::filesystem::path& file, const Json& gltf);

/// Of a document or a container that says it is 1.0. Errors  InputError, with what converts it.
[[noreturn]] void refuse_gltf_1(const std::filesystem::path& file);

}  // namespace gigabake
