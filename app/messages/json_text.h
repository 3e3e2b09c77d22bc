/// The text of JSON that a command prints or writes.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace gigabake::app {

/// Returns `json` as text, on one line if `indent` is -1. Replaces invalid UTF-8, which file names may contain, by
/// U+FFFD.
std::string json_text(const nlohmann::ordered_json& json, int indent = 2);

}  // namespace gigabake::app
