/// The warnings of a mesh file, counted while its lines and faces are read: there may be one for each of 10^8 faces.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "format/source/source_warning.h"

namespace gigabake {

/// One warning per kind, in the order of their first examples.
class MeshWarnings {
 public:
  /// Counts one more of a kind. example: converted to a text in the first call only.
  template <class Example>
  void count(std::string_view text, const Example& example) {
    if (!count_known(text, false)) list_.push_back(first(text, example, false));
  }
  /// As count(), for a part of the file that costs triangles.
  template <class Example>
  void count_loss(std::string_view text, const Example& example) {
    if (!count_known(text, true)) list_.push_back(first(text, example, true));
  }
  /// Adds the warnings of another file that belongs to this one.
  void add(const MeshWarnings& other);
  /// States out of how many things those of a kind are; does nothing if none was counted.
  void set_of(std::string_view text, std::uint64_t of);
  /// Returns the warnings and forgets them.
  std::vector<SourceWarning> take() { return std::exchange(list_, {}); }

 private:
  bool count_known(std::string_view text, bool is_loss);
  static SourceWarning first(std::string_view text, const std::string& example, bool is_loss);

  std::vector<SourceWarning> list_;
};

}  // namespace gigabake
