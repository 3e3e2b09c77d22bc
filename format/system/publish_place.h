/// Steps of publishing a file or folder, and their error messages.
#pragma once

#include <filesystem>
#include <functional>

namespace gigabake {

/// Throws InputError "cannot WHAT: the system's reason", with the reason from errno.
[[noreturn]] void fail_to(const std::filesystem::path& path, const char* what);

/// Returns the folder that contains `path`.
std::filesystem::path folder_of(const std::filesystem::path& path);

/// Returns a new name next to `target`, for which make(name) succeeded. `make` returns true on success, or false with
/// the reason in errno.
/// Errors  InputError if `make` fails for another reason than an existing name.
std::filesystem::path create_temporary(const std::filesystem::path& target,
                                       const std::function<bool(const std::filesystem::path&)>& make);

/// Renames the complete file or folder `temporary` to `target`, and replaces an existing target.
/// Errors  InputError with the system's reason.
void rename_into_place(const std::filesystem::path& temporary, const std::filesystem::path& target);

/// Flushes the folder of `target`, so that its entries survive a power loss.
/// Errors  InputError with the system's reason.
void flush_folder_of(const std::filesystem::path& target);
/// Flushes the content of one file.
/// Errors  InputError with the system's reason.
void flush_file(const std::filesystem::path& file);

}  // namespace gigabake
