/// Handling of failed allocations from which no exception can propagate.
#pragma once

namespace gigabake::app {

/// Installs a terminate handler for failed allocations, for example in a destructor or a library's thread. The process
/// then prints one line and exits with `failed` instead of dumping core. Other causes of std::terminate() are
/// unaffected.
void install_out_of_memory_handler();

}  // namespace gigabake::app
