/// Reasons of missing inputs and warnings, printed behind the name of the file.
#pragma once

#include <filesystem>
#include <string>

namespace gigabake {

/// Returns the text of an InputError without the file and the key, which the caller prints in front of the reason. A
/// long path may be shortened in the error, but not the file's own name.
std::string reason_without_place(const std::string& error, const std::filesystem::path& file, const std::string& key);

}  // namespace gigabake
