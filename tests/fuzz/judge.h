/// Whether a reader behaved.
#pragma once

#include <string>

#include "tests/fuzz/readers.h"

namespace gigabake::fuzz {

using Reader = void (*)(Bytes);

/// What was wrong: an error that is none of ours, or one that is not one clear line. Empty: read, or refused in one.
std::string fault_of(Reader reader, Bytes bytes);

}  // namespace gigabake::fuzz
