#include "format/source/source_warning.h"

namespace gigabake {

std::string SourceWarning::line() const {
  std::string out = text;
  if (count != 0) out += ": " + std::to_string(count);
  if (of != 0) out += " of " + std::to_string(of);
  if (!example.empty()) out += ", e.g. " + example;
  return out;
}

void SourceWarnings::add(const SourceWarnings& other) {
  list_.insert(list_.end(), other.list_.begin(), other.list_.end());
}

void SourceWarnings::set_of(std::string_view text, std::uint64_t of) {
  for (SourceWarning& known : list_)
    if (known.text == text) known.of = of;
}

bool SourceWarnings::count_known(std::string_view text, bool is_loss) {
  for (SourceWarning& known : list_)
    if (known.is_loss == is_loss && known.text == text) return ++known.count, true;
  return false;
}

SourceWarning SourceWarnings::first(std::string_view text, const std::string& example, bool is_loss) {
  SourceWarning warning{std::string(text)};
  warning.count = 1;
  warning.example = example;
  warning.is_loss = is_loss;
  return warning;
}

}  // namespace gigabake
