/// Messages for people, on standard error: the one place that writes there.
#pragma once

#include <cstdio>
#include <fmt/format.h>
#include <string_view>
#include <utility>

namespace gigabake {

/// Writes whole lines. A message that cannot be written (a full disk, a closed pipe) is dropped: it must not end what
/// it speaks of. Thread-safe; lines of one call stay together.
void write_message(std::string_view lines);

template <class... Values>
void print_message(fmt::format_string<Values...> form, Values&&... values) {
  write_message(fmt::format(form, std::forward<Values>(values)...));
}

/// Writes a part of a line as it is, to a terminal's last line, say. Like write_message() on standard error; on another
/// stream a failure shows when that stream is flushed at the end of the program.
void write_part(std::FILE* stream, std::string_view text);

/// While it exists each line of write_message() begins with the time (UTC) and the rank, as in
/// "2026-11-25T05:12:33Z rank 0: ". One at a time in a process.
class MessageTime {
 public:
  explicit MessageTime(int rank);
  ~MessageTime();
  MessageTime(const MessageTime&) = delete;
  MessageTime& operator=(const MessageTime&) = delete;
};

}  // namespace gigabake
