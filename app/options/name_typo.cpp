#include "app/options/name_typo.h"

#include <algorithm>
#include <iterator>
#include <string>
#include <utility>
#include <vector>

namespace gigabake::app {
namespace {

constexpr std::size_t min_word_letters = 3;

bool is_lower(char c) { return c >= 'a' && c <= 'z'; }
bool is_upper(char c) { return c >= 'A' && c <= 'Z'; }
bool is_number(char c) { return c >= '0' && c <= '9'; }
bool is_letter(char c) { return is_lower(c) || is_upper(c) || (static_cast<unsigned char>(c) & 0x80); }
char lower(char c) { return is_upper(c) ? char(c - 'A' + 'a') : c; }

/// Returns the letters and digits of `name` in lower case.
std::string without_separators(std::string_view name) {
  std::string out;
  for (const char c : name)
    if (is_letter(c) || is_number(c)) out += lower(c);
  return out;
}

std::string digits_of(std::string_view name) {
  std::string out;
  std::copy_if(name.begin(), name.end(), std::back_inserter(out), is_number);
  return out;
}

/// Returns the words of `name` in lower case. Digits, separators and the start of a camelCase word end a word.
std::vector<std::string> words_of(std::string_view name) {
  std::vector<std::string> words(1);
  for (std::size_t i = 0; i < name.size(); ++i) {
    const bool starts_word = i > 0 && is_upper(name[i]) && is_lower(name[i - 1]);
    if (!words.back().empty() && (!is_letter(name[i]) || starts_word)) words.emplace_back();
    if (is_letter(name[i])) words.back() += lower(name[i]);
  }
  if (words.back().empty()) words.pop_back();
  return words;
}

/// Returns true if one inserted, removed or replaced letter, or a swap of two neighbours, turns one word into the
/// other. A different last letter is a suffix and not a typo, unless it repeats the letter before it.
bool is_one_typo_apart(std::string_view a, std::string_view b) {
  if (a.size() < b.size()) std::swap(a, b);
  if (a.size() < min_word_letters) return false;
  const auto first = std::size_t(std::mismatch(b.begin(), b.end(), a.begin()).first - b.begin());
  const std::string_view rest_a = a.substr(first), rest_b = b.substr(first);
  if (a.size() == b.size() + 1) return rest_a.substr(1) == rest_b && (!rest_b.empty() || rest_a[0] == a[first - 1]);
  if (a.size() != b.size() || rest_a.size() < 2) return false;
  if (rest_a.substr(1) == rest_b.substr(1)) return true;
  return rest_a[0] == rest_b[1] && rest_a[1] == rest_b[0] && rest_a.substr(2) == rest_b.substr(2);
}

}  // namespace

bool looks_like_typo(std::string_view name, std::string_view other) {
  if (name == other) return false;
  if (without_separators(name) == without_separators(other)) return true;
  if (digits_of(name) != digits_of(other)) return false;
  const std::vector<std::string> words = words_of(name), others = words_of(other);
  if (words.size() != others.size()) return false;
  const auto [word, of_other] = std::mismatch(words.begin(), words.end(), others.begin());
  return word != words.end() && std::equal(word + 1, words.end(), of_other + 1) && is_one_typo_apart(*word, *of_other);
}

}  // namespace gigabake::app
