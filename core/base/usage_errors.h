/// Errors of a file that the user's arguments name, as errors of these arguments.
#pragma once

#include "core/base/error.h"

namespace gigabake {

/// Returns the result of `read`. Turns an InputError into a UsageError with the same text.
template <class Read>
auto with_usage_errors(const Read& read) {
  try {
    return read();
  } catch (const InputError& e) {
    throw UsageError(e.what());
  }
}

}  // namespace gigabake
