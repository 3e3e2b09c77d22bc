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
  Json value;               ///< its complete part
  std::string key;          ///< of an object: the member that is being read
  std::uint64_t items = 0;  ///< of an array: complete items, so the index of the item that is being read
  std::uint64_t bytes = 0;  ///< approximate bytes of memory
};

/// A callback for every complete object, the innermost first. around: from the document inwards. Returns true if the
/// callee has used the object; it is then dropped from the document. May throw InputError.
using JsonFold = std::function<bool(const std::vector<OpenJson>& around, Json& complete)>;

/// Parses JSON. Strings of any bytes are accepted: repaired_json().
/// Errors  InputError: not JSON (line, byte and the expected token), nested deeper than 128, longer than 2^28 bytes, or
///         more values than memory_limit() allows (core/base/memory_limit.h).
Json parse_json(const std::filesystem::path& file, std::span<const std::uint8_t> text, const JsonFold& fold = {});

}  // namespace gigabake
