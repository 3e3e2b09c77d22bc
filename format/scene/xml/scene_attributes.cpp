#include "format/scene/xml/scene_attributes.h"

#include <algorithm>

namespace gigabake {

std::string_view SceneAttributes::view(const char* key) const {
  const pugi::xml_attribute a = node_.attribute(key);
  if (!a) fail(key, "is missing");
  return a.value();
}

std::vector<std::string_view> SceneAttributes::words(std::string_view text) {
  constexpr std::string_view blanks = " \t\n\v\f\r";
  std::vector<std::string_view> all;
  while (true) {
    const std::size_t begin = text.find_first_not_of(blanks);
    if (begin == std::string_view::npos) return all;
    text.remove_prefix(begin);
    const std::size_t end = std::min(text.find_first_of(blanks), text.size());
    all.push_back(text.substr(0, end));
    text.remove_prefix(end);
  }
}

std::vector<Hash128> SceneAttributes::hashes(const char* key) const {
  std::vector<Hash128> out;
  for (const std::string_view word : words(view(key))) {
    const auto h = Hash128::from_hex(word);
    if (!h) fail(key, "expected 32 hexadecimal digits, got " + in_quotes(word));
    out.push_back(*h);
  }
  return out;
}

Hash128 SceneAttributes::hash(const char* key) const {
  const std::vector<Hash128> all = hashes(key);
  if (all.size() != 1) fail(key, "expected one hash");
  return all[0];
}

std::vector<SceneFault> SceneAttributes::unknown_parts(std::span<const std::string_view> known,
                                                       std::span<const std::string_view> known_elements) const {
  std::vector<SceneFault> faults;
  std::uint64_t seen = 0;  // one bit for each of `known`
  for (const pugi::xml_attribute a : node_.attributes()) {
    const std::string_view name = a.name();
    const auto at = std::find(known.begin(), known.end(), name);
    const std::uint64_t bit = at == known.end() ? 0 : std::uint64_t(1) << (at - known.begin());
    if (bit == 0) faults.push_back(fault(as_line(name, max_quote_bytes), "is not an attribute of this element"));
    if ((seen & bit) != 0) faults.push_back(fault(as_line(name, max_quote_bytes), "occurs twice"));
    seen |= bit;
  }
  for (const pugi::xml_node child : node_.children()) {
    const std::string_view name = child.name();
    if (child.type() != pugi::node_element)
      faults.push_back(fault("", "holds " + in_quotes(child.value()) + ", which is not an element"));
    else if (std::find(known_elements.begin(), known_elements.end(), name) == known_elements.end())
      faults.push_back(fault(as_line(name, max_quote_bytes), "is not allowed in this element"));
  }
  return faults;
}

SceneFault SceneAttributes::fault(const std::string& key, const std::string& what) const {
  const std::string element = as_line(node_.name(), max_quote_bytes);
  return {key.empty() ? element : element + " " + key, what, std::uint64_t(node_.offset_debug())};
}

void SceneAttributes::fail(const char* key, const std::string& what) const { throw error_of(file_, fault(key, what)); }

}  // namespace gigabake
