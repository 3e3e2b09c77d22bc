/// Parts of a source that a bake ignores or changes: counted per class, with the first example.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "format/source/mesh.h"

namespace gigabake {

/// Text of the warning about vertex normals of length zero or with a component that is not finite.
inline constexpr const char* bad_vertex_normals =
    "vertex normals without a direction, replaced by the normals of the triangles";

/// A counter of the warnings of one source, with one entry per class of warnings. The entries are in the order of their
/// first warnings.
/// Warnings are counted, not listed, because each of 10^8 faces may cause one warning.
class SourceWarnings {
 public:
  /// Counts one more warning of the class `text`. `example` is converted to a string only for the first warning of the
  /// class.
  template <class Example>
  void count(std::string_view text, const Example& example) {
    if (!count_known(text, false)) list_.push_back(first(text, example, false));
  }
  /// Counts like count(), for a part of the source whose triangles are missing.
  template <class Example>
  void count_loss(std::string_view text, const Example& example) {
    if (!count_known(text, true)) list_.push_back(first(text, example, true));
  }
  /// Adds the warnings of another file that belongs to the source.
  void add(const SourceWarnings& other);
  /// Sets the total number of parts of a class; does nothing if no warning of the class was counted.
  void set_of(std::string_view text, std::uint64_t of);
  /// Returns the warnings and clears them.
  std::vector<SourceWarning> take() { return std::exchange(list_, {}); }

 private:
  bool count_known(std::string_view text, bool is_loss);
  static SourceWarning first(std::string_view text, const std::string& example, bool is_loss);

  std::vector<SourceWarning> list_;
};

/// Visits the fields that are stored in messages between processes and in scratch files. `f` is ByteWriter::put or
/// ByteReader::get.
template <class Warning, class F>
void each_field_of_warning(Warning& w, const F& f) {
  f(w.text), f(w.count), f(w.of), f(w.example), f(w.is_loss);
}

}  // namespace gigabake
