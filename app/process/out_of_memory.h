/// Handling of failed allocations from which no exception can propagate.
#pragma once

namespace gigabake::app {

/// Installs a terminate handler for failed allocations, for example in a destructor or a library's thread. The process
/// then prints one line and exits with `failed` instead of dumping core. Other causes of std::terminate() are
/// unaffected.
void say_so_where_memory_ends();

}  // namespace gigabake::app
