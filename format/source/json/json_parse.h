/// Parser for untrusted JSON: it checks nesting and memory, and can drop items of long lists while it reads.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

namespace gigabake {

using Json = nlohmann::json;

/// An object or array that is not complete yet and contains the current value.
struct OpenJson {
  Json value;               ///< the part that has been read
  std::string key;          ///< in an object: name of the member that is being read
  std::uint64_t items = 0;  ///< in an array: number of complete items, which is the index of the next item
  std::uint64_t bytes = 0;  ///< approximate memory of `value` in bytes
};

/// A callback for every complete object; inner objects precede the objects that contain them. `around` lists the
/// incomplete objects and arrays that contain the object, the outermost first. If the callback returns true, the object
/// is dropped from the document. The callback may throw InputError.
using JsonFold = std::function<bool(const std::vector<OpenJson>& around, Json& complete)>;

/// Parses JSON. Invalid bytes in strings are replaced by repaired_json().
/// Errors  InputError: the text is not JSON (with line, byte and expected token), begins with a byte order mark, or is
///         nested deeper than 128 levels. Also if it exceeds 2^28 bytes, or its values exceed memory_limit()
///         (core/base/memory_limit.h).
Json parse_json(const std::filesystem::path& file, std::span<const std::uint8_t> text, const JsonFold& fold = {});

}  // namespace gigabake
