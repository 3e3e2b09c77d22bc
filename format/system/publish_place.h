/// Steps of publishing a file or folder, and their error messages.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include "format/system/descriptor.h"

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

/// Returns the name of the target if `name` is a name that create_temporary() gives: ".TARGET.PID-N.part".
std::optional<std::string> target_of_temporary(const std::string& name);

/// A temporary file or folder and the lock (flock) that its owner holds on it. The lock ends with the process, so a
/// temporary without a lock has no owner. On file systems without flock there is no lock.
struct LockedTemporary {
  std::filesystem::path path;
  Descriptor lock;
};

/// Returns a new name next to `target` that make(name) created and opened, and locks it.
/// Errors  InputError if `make` fails for another reason than an existing name.
LockedTemporary create_locked_temporary(const std::filesystem::path& target,
                                        const std::function<Descriptor(const std::filesystem::path&)>& make);

/// Removes the temporary files and folders of `target` whose owners were killed. Keeps those that cannot be locked.
/// Cost    Lists the folder of `target`.
void remove_abandoned_temporaries(const std::filesystem::path& target);

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
