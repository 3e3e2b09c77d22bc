/// Failed I/O, apart from bad input: the same file may be read or written another time.
#pragma once

#include "lattice/error.h"

namespace gigabake {

/// The system could not read or write: a disk that is full, a server that does not answer, a file that is gone.
class IoError : public InputError {
 public:
  using InputError::InputError;
};

}  // namespace gigabake
