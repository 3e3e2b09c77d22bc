/// The bake process: scans tiles and bakes cells for the supervisor at the other end of a socket.
#pragma once

namespace gigabake {

/// Answers requests on `fd`, a connected local socket (worker/pipeline/bake_messages.h), until the peer closes it; then
/// returns 0. The pipeline is made as soon as a device is chosen. If the CPU is chosen, the first request for a cell
/// makes it. If opening the sources or making the pipeline fails, every request that needs them is answered with the
/// error line. Tiles are scanned concurrently with cells. Scans do not wait for the choice of the device, because its
/// driver takes about a second to start. Waiting takes no CPU time. Call serve_bakes() once per process. When it
/// returns or throws, the caller must end the process immediately (std::_Exit), because threads are still running.
/// Errors  InputError if a message is malformed; std::system_error if a system call fails.
int serve_bakes(int fd);

}  // namespace gigabake
