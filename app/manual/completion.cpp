#include "app/manual/completion.h"

#include <fmt/format.h>
#include <utility>

#include "app/options/choices.h"

namespace gigabake::app {
namespace {

/// Returns the text in single quotes, which bash, zsh and fish accept.
std::string quoted(const std::string& text) {
  std::string out = "'";
  for (const char c : text) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return out + "'";
}

/// Returns the words, except options and files, that may follow the command, each with its description.
std::vector<std::pair<std::string, std::string>> following_words(const Command& command) {
  std::vector<std::pair<std::string, std::string>> words;
  for (const Command& below : command.commands) words.emplace_back(below.path.back(), below.description);
  for (const CommandOption& o : command.options)
    if (o.is_positional)
      for (const std::string& choice : o.choices) words.emplace_back(choice, o.description);
  return words;
}

std::vector<std::string> command_names(const Command& command) {
  std::vector<std::string> names;
  for (const auto& [word, description] : following_words(command)) names.push_back(word);
  return names;
}

/// Returns one line of a shell's case statement per command. Each line sets `at` to the command's name.
std::string path_cases(const Command& root, const std::string& indent) {
  std::string text;
  for (const Command* command : all_commands(root))
    if (command->path.size() > 1)
      text += fmt::format("{}{}) at={} ;;\n", indent, quoted(command->name()), quoted(command->name()));
  return text;
}

/// Returns the option's names with the command, such as "'gigabake export --to'", joined by " | ".
std::string patterns(const Command& command, const CommandOption& o) {
  std::string text;
  for (const std::string& name : o.names) text += (text.empty() ? "" : " | ") + quoted(command.name() + " " + name);
  return text;
}

}  // namespace

std::string bash_completion(const Command& root) {
  std::string values, words;
  for (const Command* command : all_commands(root)) {
    for (const CommandOption& o : command->options) {
      if (o.is_positional || o.value.empty()) continue;
      values += fmt::format("    {})\n      ", patterns(*command, o));
      values += o.choices.empty()
                    ? "COMPREPLY=($(compgen -f -- \"$cur\"))\n"
                    : fmt::format("COMPREPLY=($(compgen -W {} -- \"$cur\"))\n", quoted(joined(o.choices, " ")));
      values += "      return ;;\n";
    }
    words += fmt::format("    {}) commands={} options={} ;;\n", quoted(command->name()),
                         quoted(joined(command_names(*command), " ")), quoted(joined(command->option_names(), " ")));
  }
  const std::string& name = root.path[0];
  return fmt::format(R"(# bash completion for {0}
_{0}() {{
  local cur=${{COMP_WORDS[COMP_CWORD]}} prev=${{COMP_WORDS[COMP_CWORD - 1]}} at={0} word commands= options=
  for word in "${{COMP_WORDS[@]:1:COMP_CWORD-1}}"; do
    case "$at $word" in
{1}    esac
  done
  compopt -o filenames 2>/dev/null
  case "$at $prev" in
{2}  esac
  compopt +o filenames 2>/dev/null
  case "$at" in
{3}  esac
  if [[ $cur == -* ]]; then
    COMPREPLY=($(compgen -W "$options" -- "$cur"))
  elif [[ $commands ]]; then
    COMPREPLY=($(compgen -W "$commands" -- "$cur"))
  else
    compopt -o filenames 2>/dev/null
    COMPREPLY=($(compgen -f -- "$cur"))
  fi
}}
complete -F _{0} {0}
)",
                     name, path_cases(root, "      "), values, words);
}

std::string zsh_completion(const Command& root) {
  std::string values, words;
  for (const Command* command : all_commands(root)) {
    std::string commands, options;
    const auto described = [](std::string word, const std::string& description) {
      for (std::size_t at = 0; (at = word.find(':', at)) != std::string::npos; at += 2) word.insert(at, "\\");
      return " " + quoted(word + ":" + description);
    };
    for (const auto& [word, description] : following_words(*command)) commands += described(word, description);
    for (const CommandOption& o : command->options) {
      if (o.is_positional) continue;
      for (const std::string& option : o.names) options += described(option, o.description);
      if (o.value.empty()) continue;
      values += fmt::format("    {}) ", patterns(*command, o));
      values += o.choices.empty() ? "_files" : "compadd -- " + joined(o.choices, " ");
      values += "; return ;;\n";
    }
    words += fmt::format("    {}) commands=({}) options=({}) ;;\n", quoted(command->name()), commands, options);
  }
  const std::string& name = root.path[0];
  return fmt::format(R"(#compdef {0}
_{0}() {{
  local at={0} word
  local -a commands options
  for word in "${{(@)words[2,CURRENT-1]}}"; do
    case "$at $word" in
{1}    esac
  done
  case "$at ${{words[CURRENT-1]}}" in
{2}  esac
  case "$at" in
{3}  esac
  if [[ ${{words[CURRENT]}} == -* ]]; then
    _describe -o option options
  elif (( $#commands )); then
    _describe command commands
  else
    _files
  fi
}}
if [[ $funcstack[1] == _{0} ]]; then _{0} "$@"; else compdef _{0} {0}; fi
)",
                     name, path_cases(root, "      "), values, words);
}

std::string fish_completion(const Command& root) {
  const std::string& name = root.path[0];
  std::string text = fmt::format(R"(# fish completion for {0}
function __{0}_at
  set -l at {0}
  for word in (commandline -opc)[2..]
    switch "$at $word"
)",
                                 name);
  for (const Command* command : all_commands(root))
    if (command->path.size() > 1) text += fmt::format("      case {0}\n        set at {0}\n", quoted(command->name()));
  text += "    end\n  end\n  test \"$at\" = \"$argv\"\nend\n";
  for (const Command* command : all_commands(root)) {
    const std::string line =
        fmt::format("complete -c {} -n {}", name, quoted(fmt::format("__{}_at {}", name, command->name())));
    for (const auto& [word, description] : following_words(*command))
      text += fmt::format("{} -f -a {} -d {}\n", line, quoted(word), quoted(description));
    for (const CommandOption& o : command->options) {
      if (o.is_positional) continue;
      text += line;
      for (const std::string& option : o.names)
        text += option.starts_with("--") ? " -l " + quoted(option.substr(2)) : " -s " + quoted(option.substr(1));
      if (!o.choices.empty())
        text += " -x -a " + quoted(joined(o.choices, " "));
      else if (!o.value.empty())
        text += " -r -F";
      text += " -d " + quoted(o.description) + "\n";
    }
  }
  return text;
}

}  // namespace gigabake::app
