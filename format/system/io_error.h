/// I/O failures, as distinguished from bad input: a retry on the same file may succeed.
#pragma once

#include "core/base/error.h"

namespace gigabake {

/// A failure of the system to read or write: a full disk, a server that does not respond, a file that disappeared.
class IoError : public InputError {
 public:
  using InputError::InputError;
};

}  // namespace gigabake
