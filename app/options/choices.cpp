#include "app/options/choices.h"

#include <algorithm>

namespace gigabake::app {
namespace {

constexpr std::size_t max_list_characters = 200;  // characters; longer lists do not fit into a one-line message

}  // namespace

std::string joined(const std::vector<std::string>& words, const char* separator) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : separator) + word;
  return text;
}

CLI::Validator one_of(const std::vector<std::string>& words) {
  const auto check = [words](std::string& text) {
    if (std::find(words.begin(), words.end(), text) != words.end()) return std::string();
    const std::string all = joined(words);
    if (all.size() > max_list_characters)
      return "there is no '" + text + "'; --help lists all " + std::to_string(words.size());
    return "expected one of " + all + ", got '" + text + "'";
  };
  return {check, "{" + joined(words, "|") + "}", "one of"};
}

std::vector<std::string> choices_in(const std::string& type_name) {
  const std::size_t begin = type_name.find('{'), end = type_name.rfind('}');
  if (begin == std::string::npos || end == std::string::npos) return {};
  return CLI::detail::split(type_name.substr(begin + 1, end - begin - 1), '|');
}

}  // namespace gigabake::app
