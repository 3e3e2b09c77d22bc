/// Extensions of a glTF object in tinygltf's types.
#pragma once

#include <tiny_gltf.h>

#include "format/source/json/json_parse.h"

namespace gigabake {

/// Converts a JSON value. Null, empty arrays and empty objects become null, and arrays and objects omit null, as in
/// tinygltf's parser. A whole number that is too large for an int becomes a double.
tinygltf::Value value_of(const Json& json);

/// Returns the extensions of an object. An extension that is not read gets no members, because its value can be large.
/// Lists of ids keep null and empty items, unlike value_of(), because their items are found by number.
tinygltf::ExtensionMap extensions_of(const Json& object);

}  // namespace gigabake
