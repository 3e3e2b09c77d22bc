#include "app/manual/man_page.h"

#include <fmt/format.h>

#include "app/manual/help_sections.h"

namespace gigabake::app {
namespace {

constexpr std::size_t max_list_characters_in_head = 60;  // characters

/// Escapes text for troff: escapes and requests are printed literally, and dashes can be copied into a shell.
std::string troff(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '\\')
      out += "\\e";
    else if (c == '-')
      out += "\\-";
    else if (c == '\'')
      out += "\\(aq";
    else if (c == '`')
      out += "\\(ga";
    else
      out += c;
  }
  return out.starts_with('.') ? "\\&" + out : out;
}

std::string bold(const std::string& text) { return "\\fB" + troff(text) + "\\fR"; }
std::string italic(const std::string& text) { return "\\fI" + troff(text) + "\\fR"; }

std::string listed(const CommandOption& o, const char* separator) {
  std::string all;
  for (const std::string& choice : o.choices) all += (all.empty() ? "" : separator) + bold(choice);
  return all;
}

/// Returns true if the choices are too long for the line of the option's names, which troff does not break.
bool has_long_list(const CommandOption& o) {
  std::size_t characters = 0;
  for (const std::string& choice : o.choices) characters += choice.size() + 1;
  return characters > max_list_characters_in_head;
}

std::string value_of(const CommandOption& o) {
  return o.choices.empty() || has_long_list(o) ? italic(o.value) : listed(o, "|");
}

std::string names_of(const CommandOption& o) {
  std::string text;
  for (const std::string& name : o.names) text += (text.empty() ? "" : ", ") + bold(name);
  return o.value.empty() || o.is_positional ? text : text + " " + value_of(o);
}

std::string synopsis(const Command& command) {
  std::string text = bold(command.name()) + " [" + italic("options") + "]";
  for (const CommandOption& o : command.options)
    if (o.is_required && !o.is_positional)
      text += " " + names_of({{o.names.back()}, o.value, o.choices, "", "", false, true});
  for (const CommandOption& o : command.options)
    if (o.is_positional) text += o.is_required ? " " + italic(o.names[0]) : " [" + italic(o.names[0]) + "]";
  return text + (command.commands.empty() ? "" : " " + italic("command")) + "\n";
}

std::string entry(const std::string& head, const std::string& body) { return ".TP\n" + head + "\n" + body + "\n"; }

std::string options(const Command& command, bool positionals) {
  std::string text;
  for (const CommandOption& o : command.options) {
    if (o.is_positional != positionals) continue;
    std::string body = troff(o.description.empty() ? o.value : o.description);
    if (has_long_list(o)) body += ": " + listed(o, ", ");
    if (!o.default_value.empty()) body += " [" + troff(o.default_value) + "]";
    text += entry(names_of(o), body);
  }
  return text;
}

/// Returns the help sections with their line breaks.
std::string sections(const Command& command) {
  std::string text;
  for (const HelpSection& section : help_sections(command.name())) {
    std::string title = section.title;
    for (char& c : title) c = char(std::toupper(static_cast<unsigned char>(c)));
    text += ".SH " + troff(title) + "\n.nf\n";
    for (const std::string& line : section.lines) text += troff(line) + "\n";
    text += ".fi\n";
  }
  return text;
}

}  // namespace

std::string man_file(const Command& command) { return command.name("-") + ".1"; }

std::string man_page(const Command& command, const Command& root) {
  std::string upper = command.name("-");
  for (char& c : upper) c = char(std::toupper(static_cast<unsigned char>(c)));
  std::string page = fmt::format(".TH {} 1 \"\" \"gigabake {}\" \"gigabake manual\"\n", troff(upper), GIGABAKE_VERSION);
  page += ".SH NAME\n" + troff(command.name("-")) + " \\- " + troff(command.description) + "\n";
  page += ".SH SYNOPSIS\n" + synopsis(command);
  const std::string arguments = options(command, true);
  if (!arguments.empty()) page += ".SH ARGUMENTS\n" + arguments;
  if (!command.commands.empty()) {
    page += ".SH COMMANDS\n";
    for (const Command& below : command.commands)
      page += entry(bold(below.path.back()), troff(below.description) + ": " + bold(below.name("-")) + "(1)");
  }
  page += ".SH OPTIONS\n" + options(command, false);
  page += sections(command);
  page +=
      ".SH EXIT STATUS\n" + entry("0", "complete") + entry("1", "failed; one line states the reason") +
      entry("2", "wrong usage") + entry("3", "some cells or sources are missing; the last lines list them") +
      entry("69", "under mpirun: a rank died or stopped responding, and the launch ended; the same command resumes") +
      entry("75", "drained: the same command resumes");
  page += ".SH SEE ALSO\n";
  std::string others;
  for (const Command* other : all_commands(root))
    if (other != &command && (other->path.size() < 3 || command.path.size() > 1))
      others += (others.empty() ? "" : ",\n") + bold(other->name("-")) + "(1)";
  return page + others + "\n";
}

}  // namespace gigabake::app
