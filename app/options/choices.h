/// Options that take one of a few words: the parser refuses others, and help, manual and completion list them all.
#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>
#include <vector>

#include "lattice/rules.h"

namespace gigabake::app {

/// "auto, cpu, cuda"
std::string joined(const std::vector<std::string>& words, const char* separator = ", ");

/// For CLI::Option::check(). The words may hold commas. CLI11's own IsMember says "gpu not in {auto,cpu}", and writes
/// that list, in which words with commas cannot be told apart, where completion finds it.
CLI::Validator one_of(const std::vector<std::string>& words);

/// Of an enum with names_of().
template <class Enum>
std::vector<std::string> words_of() {
  constexpr auto names = names_of<Enum>();
  return {names.begin(), names.end()};
}

/// An option that takes a value's name. The default is `value`, which lives as long as the command; the help says it.
template <class Enum>
CLI::Option* add_choice(CLI::App& command, const std::string& name, Enum& value, const std::string& description) {
  const auto take = [&value](const std::string& word) { value = value_named<Enum>(word).value(); };
  return command.add_option_function<std::string>(name, take, description)
      ->default_str(std::string(name_of(value)))
      ->check(one_of(words_of<Enum>()));
}
/// None where the option is not given.
template <class Enum>
CLI::Option* add_choice(CLI::App& command, const std::string& name, std::optional<Enum>& value,
                        const std::string& description) {
  const auto take = [&value](const std::string& word) { value = value_named<Enum>(word).value(); };
  return command.add_option_function<std::string>(name, take, description)->check(one_of(words_of<Enum>()));
}

/// The choices in a type's name as one_of() writes it, "TEXT:{auto|cpu|cuda}"; none where it has no list.
std::vector<std::string> choices_in(const std::string& type_name);

}  // namespace gigabake::app
