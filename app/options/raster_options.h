/// The options that state what elevation rasters of a source leave open. A scene .json has keys with the same meaning.
#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>
#include <vector>

#include "format/source/source.h"

namespace gigabake::app {

struct RasterArguments {
  std::string ortho, crs;
  std::vector<double> nodata;
  std::optional<double> geoid_offset_m;

  void add_to(CLI::App& command);
  /// Returns the options for open_sources().
  /// Errors  UsageError: the orthophoto does not exist, a number is not finite, or --dem-crs is unknown.
  RasterOptions options() const;
  /// Returns the options as text; empty if none is given.
  std::string text() const;
};

}  // namespace gigabake::app
