/// Exceptions for bad input, failed I/O and failures of a device. Each message is one line: the place, the expected
/// value and the remedy.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>

namespace gigabake {

/// The max bytes of a message that contains paths, the key and quoted texts in full. A longer message loses the middle
/// of these texts (core/base/quote.h). The message's own words are never shortened.
inline constexpr std::size_t max_message_bytes = 240;

/// The message for a failed allocation.
inline constexpr const char* not_enough_memory =
    "not enough memory; give the process more, or use fewer ranks on the machine, fewer threads or smaller tiles";

/// Returns `text` as one line: control characters become spaces. A text longer than `max_bytes` is shortened. If
/// `max_bytes` (at least 8) is below 200, the text is cut at its end and gets a "…". Otherwise, each word longer than
/// max_path_bytes loses its middle, as does a line longer than max_line_bytes.
std::string as_line(std::string_view text, std::size_t max_bytes = max_message_bytes);

/// The max length of a file's text that a message quotes.
inline constexpr std::size_t max_quote_bytes = 60;

/// Returns a file's text for a message, on one line and in quotes. A text longer than max_quote_bytes loses its middle.
std::string in_quotes(std::string_view text);

/// Returns the message for the user: what(), or the remedy if memory or processes ran out.
std::string reason_of(const std::exception& error);

/// An error in a file or in an operation on it. `what()` is one line, "FILE: KEY: MESSAGE (at byte N)", or "KEY:
/// MESSAGE" without a file. If the line would exceed max_message_bytes, paths and the key lose their middle; cause and
/// remedy remain. A bake catches the error for each cell; else run_program() (app/process/run_program.h) catches it.
class InputError : public std::runtime_error {
 public:
  InputError(const std::filesystem::path& file, const std::string& key, const std::string& message,
             std::optional<std::uint64_t> byte_offset = {});
};

/// A failure of the system to read or write: a full disk, a server that does not respond, a file that disappeared. A
/// retry on the same file may succeed.
class IoError : public InputError {
 public:
  using InputError::InputError;
};

/// The CUDA device has no free memory or is lost. The cell can be baked on another device or on the CPU.
class CudaFailure : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// An allocation exceeds the limit, the device's free memory or 32-bit indices. Smaller batches may fit.
class DeviceFull : public CudaFailure {
 public:
  using CudaFailure::CudaFailure;
};

/// An invalid option or combination of options; exit code 2. `what()` has the format of InputError's.
///
/// Messages of libraries name a field of a struct between backquotes, because a library has no command-line options.
/// app/options/flags.h replaces the field by its option before the message is printed.
class UsageError : public std::runtime_error {
 public:
  explicit UsageError(const std::string& message) : std::runtime_error(as_line(message)) {}
  /// Sets the message "`FIELD`: MESSAGE" for one field with a wrong value.
  UsageError(std::string_view field, const std::string& message)
      : std::runtime_error(as_line("`" + std::string(field) + "`: " + message)), field_(field) {}
  /// Returns the field with the wrong value; empty if the error concerns several fields or none.
  const std::string& field() const { return field_; }

 private:
  std::string field_;
};

}  // namespace gigabake
