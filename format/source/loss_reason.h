/// Reasons of missing inputs and of warnings. Messages print the reason after the file name.
#pragma once

#include <filesystem>
#include <string>

namespace gigabake {

/// Returns the text of an InputError without the file and the key, which the caller prints in front of the reason.
/// `error` may contain a shortened path, but always contains the complete file name.
std::string reason_without_place(const std::string& error, const std::filesystem::path& file, const std::string& key);

}  // namespace gigabake
