#include "format/source/mesh/mesh_warnings.h"

namespace gigabake {

void MeshWarnings::add(const MeshWarnings& other) { list_.insert(list_.end(), other.list_.begin(), other.list_.end()); }

void MeshWarnings::set_of(std::string_view text, std::uint64_t of) {
  for (SourceWarning& known : list_)
    if (known.text == text) known.of = of;
}

bool MeshWarnings::count_known(std::string_view text, bool is_loss) {
  for (SourceWarning& known : list_)
    if (known.is_loss == is_loss && known.text == text) return ++known.count, true;
  return false;
}

SourceWarning MeshWarnings::first(std::string_view text, const std::string& example, bool is_loss) {
  SourceWarning warning{std::string(text)};
  warning.count = 1;
  warning.example = example;
  warning.is_loss = is_loss;
  return warning;
}

}  // namespace gigabake
