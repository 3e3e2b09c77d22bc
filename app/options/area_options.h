/// The options of an area of interest, which all commands that read a source or a scene share.
#pragma once

#include <CLI/CLI.hpp>
#include <memory>
#include <string>

#include "format/area/area.h"

namespace gigabake::app {

struct AreaOptions {
  std::string bounds, clip, crs;

  void add_to(CLI::App& command);
  /// Returns the area; null if no option is given.
  /// Errors  UsageError: bounds are empty or swapped, the file of polygons cannot be used, or the coordinate system is
  ///         unknown or does not cover the bounds.
  std::shared_ptr<const Area> area() const;
  /// Returns the options as text; empty if none is given.
  std::string text() const;
};

}  // namespace gigabake::app
