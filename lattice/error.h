/// Bad input and failed I/O: one clear line that says where, what was expected and what to do.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>

namespace gigabake {

/// A message is a line that a person reads: whatever a file says in it is cut before it gets longer than this, which
/// leaves room for what a command prints before it.
inline constexpr std::size_t longest_message_bytes = 240;

/// The line where an allocation failed.
inline constexpr const char* not_enough_memory =
    "not enough memory; give the process more, or take fewer ranks on the machine, fewer threads or smaller tiles";

/// `text` as one line of at most `most_bytes` (at least 8): control characters become spaces. Too long a part loses its
/// end to a "…"; too long a message (200 bytes and more are allowed) the middle of its paths, then its own.
std::string as_line(std::string_view text, std::size_t most_bytes = longest_message_bytes);

/// Of a file's text in a message.
inline constexpr std::size_t longest_quote_bytes = 60;

/// Text of a file as a message shows it: in quotes, on one line, at most longest_quote_bytes of it.
std::string in_quotes(std::string_view text);

/// What a person should read of an exception: its what(), but where memory ran out, what to do.
std::string reason_of(const std::exception& error);

/// Thrown for anything wrong in a file or with an operation on it; caught at the cell boundary and in `main`.
/// `what()` is one line of at most longest_message_bytes, "FILE: KEY: MESSAGE (at byte N)": where that would be longer,
/// paths and the key lose their middle, so that cause and remedy stay. Without a FILE: "KEY: MESSAGE".
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
