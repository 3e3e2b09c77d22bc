/// A mesh file with a given text, read as a separate scene.
#pragma once

#include <gtest/gtest.h>
#include <string>

#include "core/base/error.h"
#include "format/source/source.h"
#include "source_scene.h"

namespace gigabake::test {

/// A fixture for one mesh file. The extension of its name selects the format.
class MeshFile : public testing::Test {
 protected:
  explicit MeshFile(std::string name) : name_(std::move(name)) {}
  TileMesh read(const std::string& text, const SourceOptions& options = {}) {
    sources = open_sources(folder.write(name_, text), options);
    return read_tile(sources.tiles.at(0), sources.root, ReadScope::everything);
  }
  /// Reads the file of the last read() again, in parts.
  TileMesh read_parts(const PrimitiveSink& sink) const {
    return read_tile(sources.tiles.at(0), sources.root, ReadScope::everything, sink);
  }
  std::string refusal(const std::string& text) {
    try {
      read(text);
    } catch (const InputError& e) {
      return e.what();
    }
    return "was read";
  }
  SourceFolder folder;
  SceneSources sources;

 private:
  const std::string name_;
};

}  // namespace gigabake::test
