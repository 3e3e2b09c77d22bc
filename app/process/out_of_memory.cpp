#include "app/process/out_of_memory.h"

#include <cstring>
#include <exception>
#include <new>
#include <unistd.h>

#include "app/commands.h"
#include "core/base/error.h"

namespace gigabake::app {
namespace {

std::terminate_handler terminate_otherwise = nullptr;

/// Handles std::terminate() without allocating memory.
[[noreturn]] void end_without_memory() {
  try {
    if (const std::exception_ptr error = std::current_exception()) std::rethrow_exception(error);
  } catch (const std::bad_alloc&) {
    for (const char* part : {"gigabake: ", not_enough_memory, "\n"})
      if (::write(STDERR_FILENO, part, std::strlen(part)) < 0) break;
    ::_exit(failed);
  } catch (...) {
    terminate_otherwise();  // prints the exception and aborts
  }
  terminate_otherwise();
  ::_exit(failed);
}

}  // namespace

void install_out_of_memory_handler() { terminate_otherwise = std::set_terminate(end_without_memory); }

}  // namespace gigabake::app
