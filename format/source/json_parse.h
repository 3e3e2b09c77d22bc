/// JSON of files that nobody vouches for: checked, counted and, where it is a long list, not kept.
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

/// An object or array that is not complete yet, around the one that is looked at.
struct OpenJson {
  Json value;               ///< what is complete of it
  std::string key;          ///< of an object: the member that is being read
  std::uint64_t items = 0;  ///< of an array: how many are complete, so the index of the one that is being read
  std::uint64_t bytes = 0;  ///< of memory, about
};

/// Asked for every complete object, the innermost first. around: from the document inwards. True: what it holds was
/// taken over, and the object is dropped from the document. May throw InputError.
using JsonFold = std::function<bool(const std::vector<OpenJson>& around, Json& complete)>;

/// Strings of any bytes are read: repaired_json().
/// Errors  InputError: not JSON (line, byte and what was expected), nested deeper than 128, longer than 2^28 bytes, or
///         more values than memory_limit() has room for (lattice/memory_limit.h).
Json parse_json(const std::filesystem::path& file, std::span<const std::uint8_t> text, const JsonFold& fold = {});

}  // namespace gigabake
