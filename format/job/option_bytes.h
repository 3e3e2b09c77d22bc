/// Serialization of a bake's options for the bake processes.
#pragma once

#include "core/io/bytes.h"
#include "core/octree/parameters.h"

namespace gigabake {

void put(ByteWriter& writer, const BakeParameters& parameters);
/// Reads the options.
/// Errors  InputError: the bytes end early. UsageError: see check().
BakeParameters get_parameters(ByteReader& reader);

}  // namespace gigabake
