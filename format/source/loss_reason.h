/// Reasons of losses and warnings, which follow the name of the file that they are about.
#pragma once

#include <filesystem>
#include <string>

namespace gigabake {

/// Returns the text of an InputError without the file and the key that stand in front of the reason already. A long
/// path may be shortened in the error, but not the file's own name.
std::string reason_without_place(const std::string& error, const std::filesystem::path& file, const std::string& key);

}  // namespace gigabake
