/// A bake's options as bytes, for the process that bakes.
#pragma once

#include "lattice/bytes.h"
#include "lattice/parameters.h"

namespace gigabake {

void put(ByteWriter& writer, const BakeParameters& parameters);
/// Errors  InputError: bytes that end early; UsageError as check().
BakeParameters get_parameters(ByteReader& reader);

}  // namespace gigabake
