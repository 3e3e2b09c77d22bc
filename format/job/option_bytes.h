/// Serialization of a bake's options for the bake processes.
#pragma once

#include "lattice/bytes.h"
#include "lattice/parameters.h"

namespace gigabake {

void put(ByteWriter& writer, const BakeParameters& parameters);
/// Reads the options.
/// Errors  InputError: the bytes end early. UsageError: see check().
BakeParameters get_parameters(ByteReader& reader);

}  // namespace gigabake
