/// Where something is published, how it gets there, and what is said when that fails.
#pragma once

#include <filesystem>
#include <functional>

namespace gigabake {

/// Throws InputError "cannot WHAT: the system's reason", which it takes from errno.
[[noreturn]] void fail_to(const std::filesystem::path& path, const char* what);

/// The folder that holds `path`.
std::filesystem::path folder_of(const std::filesystem::path& path);

/// A new name beside `target` at which `make` made something; false: it did not, and errno says why.
/// Errors  InputError: nothing can be made there.
std::filesystem::path make_beside(const std::filesystem::path& target,
                                  const std::function<bool(const std::filesystem::path&)>& make);

/// Renames what is whole, over what stands at the target. Errors  InputError.
void rename_into_place(const std::filesystem::path& aside, const std::filesystem::path& target);

/// What the folder of `target` lists outlives a loss of power. Errors  InputError.
void flush_folder_of(const std::filesystem::path& target);
/// Likewise the content of one file.
void flush_file(const std::filesystem::path& file);

}  // namespace gigabake
