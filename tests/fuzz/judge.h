/// A check that a reader accepts or properly refuses its input.
#pragma once

#include <string>

#include "tests/fuzz/readers.h"

namespace gigabake::fuzz {

using Reader = void (*)(Bytes);

/// Returns a description of the fault: an unexpected type of exception, or a message that is not one clear line.
/// Returns an empty string if the reader accepts the bytes or refuses them in one line.
std::string fault_of(Reader reader, Bytes bytes);

}  // namespace gigabake::fuzz
