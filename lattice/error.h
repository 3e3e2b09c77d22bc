/// Bad input and failed I/O: one clear line that says where, what was expected and what to do.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>

namespace gigabake {

/// Length from which the paths in a message, its key and whatever else a file or a command line put into it are
/// shortened in their middle (lattice/quote.h). The message's own words never are.
inline constexpr std::size_t longest_message_bytes = 240;

/// The line where an allocation failed.
inline constexpr const char* not_enough_memory =
    "not enough memory; give the process more, or take fewer ranks on the machine, fewer threads or smaller tiles";

/// Returns `text` as one line: control characters become spaces. Beyond `most_bytes` (at least 8) a part of a message
/// loses its end to a "…"; a message (200 bytes and more are allowed) loses the middle of its longest words instead.
std::string as_line(std::string_view text, std::size_t most_bytes = longest_message_bytes);

/// Of a file's text in a message.
inline constexpr std::size_t longest_quote_bytes = 60;

/// Returns text of a file for a message: in quotes, on one line, its middle left out beyond longest_quote_bytes.
std::string in_quotes(std::string_view text);

/// What a person should read of an exception: its what(), but where memory ran out, what to do.
std::string reason_of(const std::exception& error);

/// Thrown for anything wrong in a file or with an operation on it; caught at the cell boundary and in `main`.
/// `what()` is one line, "FILE: KEY: MESSAGE (at byte N)": where it is longer than longest_message_bytes, paths and the
/// key lose their middle, so that cause and remedy stay. Without a FILE: "KEY: MESSAGE".
class InputError : public std::runtime_error {
 public:
  InputError(const std::filesystem::path& file, const std::string& key, const std::string& message,
             std::optional<std::uint64_t> byte_offset = {});
};

/// Wrong options or a combination of them that means nothing; exit code 2. `what()` as InputError's.
///
/// A library knows the fields of its structs, not the options of a command line: its messages, also those of other
/// errors, name a field between backquotes, and app/options/flags.h puts the option in its place before a person reads
/// it.
class UsageError : public std::runtime_error {
 public:
  explicit UsageError(const std::string& message) : std::runtime_error(as_line(message)) {}
  /// "`FIELD`: MESSAGE", where the value of one field is wrong.
  UsageError(std::string_view field, const std::string& message)
      : std::runtime_error(as_line("`" + std::string(field) + "`: " + message)), field_(field) {}
  /// Whose value is wrong; empty where that is no single field.
  const std::string& field() const { return field_; }

 private:
  std::string field_;
};

}  // namespace gigabake
