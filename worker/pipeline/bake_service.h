/// The bake process: scans tiles and bakes cells for the supervisor at the other end of a socket.
#pragma once

namespace gigabake {

/// Answers requests on `fd`, a connected local socket (worker/pipeline/bake_messages.h), until the peer closes it; then
/// returns 0. The pipeline is made once the device is known; on the CPU, by the first cell. If opening the sources or
/// making the pipeline fails, every request that needs them is answered with the error line. Tiles are scanned
/// concurrently with cells, and while the device is chosen, because its driver takes about a second to start. Waiting
/// takes no CPU time. Call it once per process. The caller must then end the process immediately (std::_Exit), also
/// after an error, because threads are still running.
/// Errors  InputError: malformed messages; std::system_error.
int serve_bakes(int fd);

}  // namespace gigabake
