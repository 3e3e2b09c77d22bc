/// A check of a file's content. Its error names the first row that breaks a rule.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "core/base/error.h"

namespace gigabake {

struct BrokenRule {
  const std::filesystem::path& path;
  std::string dataset;

  /// Errors  InputError naming file, dataset, row and rule, if `holds` is false.
  void expect(bool holds, std::uint64_t row, const char* rule) const {
    if (!holds) throw InputError(path, dataset, "row " + std::to_string(row) + ": " + rule);
  }
};

}  // namespace gigabake
