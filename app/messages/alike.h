/// Many lines that say the same of many cells become a few.
#pragma once

#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "format/scene/scene_xml.h"

namespace gigabake::app {

/// The line without its numbers: lines that differ only in those are alike.
std::string kind_of(std::string_view line);

/// Lets the first few lines of each kind through, and the 10th, 100th, 1000th …, which then says so.
class AlikeLines {
 public:
  /// The line to show; empty: none now.
  std::string pass(const std::string& line);

 private:
  std::unordered_map<std::string, std::size_t> seen_;
};

/// One line a loss; of many that are alike the first three, and a line with the number of the others. At most 50.
std::vector<std::string> lines_of(const std::vector<SceneLoss>& losses);

}  // namespace gigabake::app
