/// Handling of full disks, closed descriptors and closed pipes on standard input, output and error. Messages are in
/// format/system/message.h.
#pragma once

namespace gigabake::app {

/// Prepares the descriptors; call it before any file is opened. Opens /dev/null on each closed standard descriptor, in
/// the direction that makes its use fail. Otherwise the next file, such as a shard, would get the descriptor's number
/// and receive messages. Ignores SIGPIPE, so that a closed pipe is a write error and does not end a bake.
void prepare_standard_streams();

/// Flushes standard output before a message that belongs after it. end_of_output() reports a failure.
void put_output_before_messages();

/// Flushes standard output.
/// Errors  std::system_error: this write or an earlier write failed.
void flush_output();

/// Returns true if a write to standard output failed.
bool has_output_failed();

/// Flushes standard output at the end of every command and returns its exit code. If output is incomplete, prints the
/// reason in one line and replaces `complete` by `failed`. A closed pipe is no failure if all work was done; otherwise
/// the process ends by SIGPIPE. `write_error` is the errno of the write that ended the work; 0 if no write did.
int end_of_output(int exit_code, int write_error);

}  // namespace gigabake::app
