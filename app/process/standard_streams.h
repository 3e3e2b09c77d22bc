/// Standard input, output and error of every command: what a full disk, a closed descriptor or a reader that left may
/// do to them. Messages are in format/system/message.h.
#pragma once

namespace gigabake::app {

/// Before anything is opened. A standard descriptor that the caller closed is taken by /dev/null, which cannot be read
/// or written in its direction: else the next file that is opened, a shard, would get its number and the messages. A
/// reader that leaves shows as an error of the write, not as a signal that ends a bake.
void prepare_standard_streams();

/// Writes out what standard output still holds, before a message that belongs behind it. A failure shows at the end.
void put_output_before_messages();

/// Writes out what standard output still holds. Errors  std::system_error: it, or an earlier write, failed.
void flush_output();

/// Returns whether a write to standard output failed.
bool has_output_failed();

/// At the end of every command. Returns exit_code, or, where standard output is not complete, prints why in one line
/// and returns `failed` instead of `complete`. A reader that left early has read what it wanted: no failure where all
/// work was done, else the end by SIGPIPE. write_error: errno of the write that ended the work, 0 where none did.
int end_of_output(int exit_code, int write_error);

}  // namespace gigabake::app
