/// Options that take one of a few words: the parser refuses others, and help, manual and completion list them all.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <utility>
#include <vector>

#include "lattice/error.h"

namespace gigabake::app {

/// "auto, cpu, cuda"
std::string joined(const std::vector<std::string>& words, const char* separator = ", ");

/// For CLI::Option::check(). The words may hold commas.
CLI::Validator one_of(const std::vector<std::string>& words);

/// What each word means.
template <class T>
struct Choices {
  std::vector<std::pair<std::string, T>> all;

  std::vector<std::string> words() const {
    std::vector<std::string> out;
    for (const auto& [word, value] : all) out.push_back(word);
    return out;
  }
  /// Errors  UsageError.
  T value_of(const char* option, const std::string& text) const {
    for (const auto& [word, value] : all)
      if (word == text) return value;
    throw UsageError(std::string(option) + ": expected one of " + joined(words()) + ", got '" + text + "'");
  }
};

/// The choices in a type's name as one_of() and CLI11 write it, "TEXT:{auto|cpu|cuda}"; none where it has no list.
std::vector<std::string> choices_in(const std::string& type_name);

}  // namespace gigabake::app
