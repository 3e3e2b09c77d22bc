#include "format/scene/scene_attributes.h"

#include <algorithm>
#include <set>

namespace gigabake {
namespace {

bool is_one_of(std::string_view name, std::initializer_list<std::string_view> known) {
  return std::find(known.begin(), known.end(), name) != known.end();
}

}  // namespace

std::string SceneAttributes::text(const char* key) const {
  const pugi::xml_attribute a = node_.attribute(key);
  if (!a) fail(key, "is missing");
  return a.value();
}

std::vector<Hash128> SceneAttributes::hashes(const char* key) const {
  std::vector<Hash128> out;
  std::istringstream words(text(key));
  for (std::string word; words >> word;) {
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

std::vector<SceneFault> SceneAttributes::unknown_parts(std::initializer_list<std::string_view> known,
                                                       std::initializer_list<std::string_view> known_elements) const {
  std::vector<SceneFault> faults;
  std::set<std::string_view> seen;
  for (const pugi::xml_attribute a : node_.attributes()) {
    const std::string_view name = a.name();
    if (!is_one_of(name, known))
      faults.push_back(fault(as_line(name, longest_quote_bytes), "is no attribute of this element"));
    if (!seen.insert(name).second) faults.push_back(fault(as_line(name, longest_quote_bytes), "stands there twice"));
  }
  for (const pugi::xml_node child : node_.children()) {
    const std::string_view name = child.name();
    if (child.type() != pugi::node_element)
      faults.push_back(fault("", "holds " + in_quotes(child.value()) + ", which is no element"));
    else if (!is_one_of(name, known_elements))
      faults.push_back(fault(as_line(name, longest_quote_bytes), "is no element of this one"));
  }
  return faults;
}

SceneFault SceneAttributes::fault(const std::string& key, const std::string& what) const {
  const std::string element = as_line(node_.name(), longest_quote_bytes);
  return {key.empty() ? element : element + " " + key, what, std::uint64_t(node_.offset_debug())};
}

void SceneAttributes::fail(const char* key, const std::string& what) const { throw error_of(file_, fault(key, what)); }

}  // namespace gigabake
