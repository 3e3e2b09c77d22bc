/// The bake process's side: surveys tiles and bakes cells for the supervisor at the other end of a socket.
#pragma once

namespace gigabake {

/// Answers what arrives on `fd`, a connected local socket (worker/bake_messages.h), until the other side hangs up; then
/// 0. Sources are taken from the setup; the pipeline is made once its device is known, or by the first cell where there
/// is none. Where that fails, the line is the answer to every request that needs it. Surveys and cells are worked on
/// side by side, and tiles are surveyed while the device is chosen, whose driver takes its second. Waiting takes no CPU
/// time. Once in a process, which the caller must end at once (std::_Exit), also after an error: threads are still at
/// work on what nobody waits for any more. Errors  InputError: malformed messages; std::system_error.
int serve_bakes(int fd);

}  // namespace gigabake
