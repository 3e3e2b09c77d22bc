/// The end of a process whose memory ended where no exception can pass.
#pragma once

namespace gigabake::app {

/// From now on std::terminate() over a failed allocation, in a destructor or a thread of a library, is one line and the
/// exit code of a failure, not an abort with a core. Anything else ends as before.
void say_so_where_memory_ends();

}  // namespace gigabake::app
