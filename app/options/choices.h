/// Options that accept one of a few words. The parser rejects other words; help, manual and completion list all of
/// them.
#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>
#include <vector>

#include "core/base/rules.h"

namespace gigabake::app {

/// Returns the words with separators between them, for example "auto, cpu, cuda".
std::string joined(const std::vector<std::string>& words, const char* separator = ", ");

/// Returns a validator for CLI::Option::check() that accepts only `words`, which may contain commas. It replaces
/// CLI11's IsMember, whose message is "gpu not in {auto,cpu}". In IsMember's list, completion could not separate words
/// that contain commas.
CLI::Validator one_of(const std::vector<std::string>& words);

/// Returns the names of an enum that has names_of().
template <class Enum>
std::vector<std::string> words_of() {
  constexpr auto names = names_of<Enum>();
  return {names.begin(), names.end()};
}

/// Adds an option that takes the name of an enum value. The default is `value`, which must outlive the command; the
/// help shows the default.
template <class Enum>
CLI::Option* add_choice(CLI::App& command, const std::string& name, Enum& value, const std::string& description) {
  const auto take = [&value](const std::string& word) { value = value_named<Enum>(word).value(); };
  return command.add_option_function<std::string>(name, take, description)
      ->default_str(std::string(name_of(value)))
      ->check(one_of(words_of<Enum>()));
}
/// Adds an option that leaves `value` empty if it is not given.
template <class Enum>
CLI::Option* add_choice(CLI::App& command, const std::string& name, std::optional<Enum>& value,
                        const std::string& description) {
  const auto take = [&value](const std::string& word) { value = value_named<Enum>(word).value(); };
  return command.add_option_function<std::string>(name, take, description)->check(one_of(words_of<Enum>()));
}

/// Returns the choices in a type name that one_of() wrote, such as "TEXT:{auto|cpu|cuda}"; empty if it has no list.
std::vector<std::string> choices_in(const std::string& type_name);

}  // namespace gigabake::app
