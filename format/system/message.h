/// Messages for the user on standard error. No other file writes to standard error.
#pragma once

#include <cstdio>
#include <fmt/format.h>
#include <string_view>
#include <utility>

namespace gigabake {

/// Writes whole lines. A message that cannot be written (full disk, closed pipe) is dropped, because it must not end
/// the operation that it reports. Thread-safe; the lines of one call stay together.
void write_message(std::string_view lines);

template <class... Values>
void print_message(fmt::format_string<Values...> form, Values&&... values) {
  write_message(fmt::format(form, std::forward<Values>(values)...));
}

/// Writes a part of a line unchanged, for example to a terminal's last line. Text that cannot be written is dropped. A
/// failure on a stream other than standard error is reported when the stream is flushed at the end of the program.
void write_part(std::FILE* stream, std::string_view text);

/// A guard: while an instance exists, each line of write_message() begins with the time (UTC) and the rank, as in
/// "2026-11-25T05:12:33Z rank 0: ". At most one instance may exist per process.
class MessageTime {
 public:
  explicit MessageTime(int rank);
  ~MessageTime();
  MessageTime(const MessageTime&) = delete;
  MessageTime& operator=(const MessageTime&) = delete;
};

}  // namespace gigabake
