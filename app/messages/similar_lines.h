/// Summaries of many similar lines about many cells.
#pragma once

#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "format/scene/xml/scene_xml.h"

namespace gigabake::app {

/// Returns the line with its numbers replaced by '#': lines that differ only in numbers are similar.
std::string kind_of(std::string_view line);

/// A filter that passes the first three lines of each group of similar lines, then the 10th, 100th, 1000th …. A later
/// line also states its number in the group.
class SimilarLineFilter {
 public:
  /// Returns the line to print; empty if it is suppressed.
  std::string pass(const std::string& line);

 private:
  std::unordered_map<std::string, std::size_t> seen_;
};

/// Returns lines that list the first three losses of each group of similar losses, then the number of the remaining
/// losses of the group. Returns at most 50 lines.
std::vector<std::string> lines_of(const std::vector<SceneLoss>& losses);

}  // namespace gigabake::app
