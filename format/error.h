/// Bad input and failed I/O: one clear line that says where, what was expected and what to do.
#pragma once

#include <filesystem>
#include <optional>
#include <stdexcept>
#include <string>

namespace gigabake {

/// Thrown for anything wrong in a file or with an operation on it; caught at the cell boundary and in `main`.
/// `what()` is one line: "FILE: KEY: MESSAGE (at byte N)".
class InputError : public std::runtime_error {
 public:
  InputError(const std::filesystem::path& file, const std::string& key, const std::string& message,
             std::optional<std::uint64_t> byte_offset = {})
      : std::runtime_error(file.string() + (key.empty() ? "" : ": " + key) + ": " + message +
                           (byte_offset ? " (at byte " + std::to_string(*byte_offset) + ")" : "")) {}
};

/// Wrong options or a combination of them that means nothing; exit code 2.
class UsageError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace gigabake
