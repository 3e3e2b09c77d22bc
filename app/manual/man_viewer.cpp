#include "app/manual/man_viewer.h"

#include <csignal>
#include <cstdio>
#include <fmt/format.h>
#include <unistd.h>

namespace gigabake::app {
namespace {

/// The programs and command lines of the viewers, in the order of preference. Each reads the page from standard input.
constexpr const char* viewers[][2] = {{"man", "man -l -"}, {"groff", "groff -K utf8 -T utf8 -man | ${PAGER:-less -R}"}};

bool is_installed(const char* program) {
  return std::system(fmt::format("command -v {} >/dev/null 2>&1", program).c_str()) == 0;
}

/// Returns false if the viewer could not show the page.
bool show_with(const char* viewer, const std::string& page) {
  std::fflush(stdout);
  std::FILE* pipe = ::popen(viewer, "w");
  if (pipe == nullptr) return false;
  const bool sent = std::fwrite(page.data(), 1, page.size(), pipe) == page.size();
  return ::pclose(pipe) == 0 && sent;
}

}  // namespace

void show_man_page(const std::string& page) {
  if (::isatty(STDOUT_FILENO) != 0) {
    std::signal(SIGPIPE, SIG_IGN);  // the viewer may close the pipe early
    for (const auto& [program, viewer] : viewers)
      if (is_installed(program) && show_with(viewer, page)) return;
  }
  fmt::print("{}", page);
}

}  // namespace gigabake::app
