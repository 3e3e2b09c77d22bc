#include "format/source/source_warning.h"

#include <algorithm>

namespace gigabake {

std::string SourceWarning::line() const {
  std::string out = text;
  if (count != 0) out += ": " + std::to_string(count);
  if (of != 0) out += " of " + std::to_string(of);
  if (!example.empty()) out += ", e.g. " + example;
  return out;
}

void SourceWarnings::add(const std::string& text, const std::string& example, bool is_loss) {
  const auto known = std::find_if(list_.begin(), list_.end(),
                                  [&](const SourceWarning& w) { return w.text == text && w.is_loss == is_loss; });
  SourceWarning& kind = known == list_.end() ? list_.emplace_back(text) : *known;
  if (++kind.count == 1) kind.example = example;
  kind.is_loss = is_loss;
}

}  // namespace gigabake
