/// A rule of a file's content, and what is said of the first row that breaks it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "lattice/error.h"

namespace gigabake {

struct BrokenRule {
  const std::filesystem::path& path;
  std::string dataset;

  /// Errors  InputError where the rule does not hold: file, dataset, row, rule.
  void expect(bool holds, std::uint64_t row, const char* rule) const {
    if (!holds) throw InputError(path, dataset, "row " + std::to_string(row) + ": " + rule);
  }
};

}  // namespace gigabake
