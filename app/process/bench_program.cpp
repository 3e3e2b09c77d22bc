#include "app/process/bench_program.h"

#include <array>
#include <cerrno>
#include <cstddef>
#include <cstdio>
#include <filesystem>
#include <fmt/format.h>
#include <stdexcept>
#include <system_error>
#include <unistd.h>
#include <utility>

#include "app/manual/about.h"

namespace gigabake::app {
namespace {

constexpr const char* program_name = "gigabake-bench";

/// Names and descriptions, in the order in which help lists them.
constexpr std::array<std::pair<const char*, const char*>, 8> bench_commands{{
    {"kernels", "Time the kernels of a source's largest cell on each available backend"},
    {"bake", "Time whole cells from files to shards: stages one by one, then overlapped"},
    {"schedule", "Simulate the schedule of a bake: synthetic terrain, virtual time, and workers that may fail"},
    {"pack", "Time Deflate of a bake's shards: on the host, on a GPU and by libdeflate"},
    {"query", "Compare the rays of `query` with rays that Embree casts through the cubes of the voxels"},
    {"render", "Time rays and frames from fixed views and along a flight"},
    {"edit", "Time edits of a shown scene: preview, files and images"},
    {"accuracy", "Measure speed and error of many settings, compared with images of the triangles"},
}};

/// Returns the folders that may contain the other program: the folder of both in a build, and its folder in an
/// installation. `installed` is relative to this program's folder.
std::array<std::filesystem::path, 2> program_folders(const char* installed) {
  const std::filesystem::path own = std::filesystem::read_symlink("/proc/self/exe").parent_path();
  return {own, (own / installed).lexically_normal()};
}

std::optional<std::filesystem::path> find_program(const char* name, const char* installed) {
  for (const std::filesystem::path& folder : program_folders(installed))
    if (const auto file = folder / name; ::access(file.c_str(), X_OK) == 0) return file;
  return std::nullopt;
}

std::optional<std::filesystem::path> find_bench() { return find_program(program_name, GIGABAKE_BENCH_FOLDER); }

std::filesystem::path bench_file() {
  if (const auto file = find_bench()) return *file;
  const auto [built, installed] = program_folders(GIGABAKE_BENCH_FOLDER);
  throw std::runtime_error(
      fmt::format("bench: the program {} is neither in {} nor in {}; install the package {}, or build gigabake with "
                  "-DGIGABAKE_BENCH=ON",
                  program_name, built.string(), installed.string(), program_name));
}

std::string caller_argument() { return bench_caller_option + build_version(); }

/// Replaces this process by gigabake-bench.
/// Errors  std::runtime_error: it is missing. std::system_error: it cannot be started.
[[noreturn]] void start_bench(const std::vector<std::string>& arguments) {
  const std::string file = bench_file().string(), caller = caller_argument();
  std::vector<char*> words{const_cast<char*>(program_name), const_cast<char*>(caller.c_str())};
  for (const std::string& argument : arguments) words.push_back(const_cast<char*>(argument.c_str()));
  words.push_back(nullptr);
  ::execv(file.c_str(), words.data());
  throw std::system_error(errno, std::generic_category(), file);
}

/// Returns the text in single quotes, so that a shell reads it as one word. The text may contain any characters.
std::string shell_word(const std::string& text) {
  std::string out = "'";
  for (const char c : text) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return out + "'";
}

}  // namespace

CLI::App& declare_bench(CLI::App& program) {
  CLI::App* bench = program.add_subcommand("bench", "Measure speed and accuracy of parts of gigabake");
  bench->require_subcommand(1);
  for (const auto& [name, description] : bench_commands) bench->add_subcommand(name, description);
  return *bench;
}

void add_bench_starter(CLI::App& program, const std::vector<std::string>& arguments) {
  for (CLI::App* command : declare_bench(program).get_subcommands([](const CLI::App*) { return true; }))
    command->preparse_callback([name = command->get_name(), arguments](std::size_t left) {
      std::vector<std::string> words{name};
      words.insert(words.end(), arguments.end() - std::ptrdiff_t(left), arguments.end());
      start_bench(words);
    });
}

std::optional<Command> bench_tree() {
  const auto file = find_bench();
  if (!file) return std::nullopt;
  const std::string call =
      fmt::format("{} {} {}", shell_word(file->string()), shell_word(caller_argument()), bench_tree_option);
  std::FILE* pipe = ::popen(call.c_str(), "r");
  if (pipe == nullptr) throw std::system_error(errno, std::generic_category(), program_name);
  std::string text;
  std::array<char, 4096> part;
  while (const std::size_t bytes = std::fread(part.data(), 1, part.size(), pipe)) text.append(part.data(), bytes);
  // gigabake-bench has printed the reason of a failure.
  return ::pclose(pipe) == 0 ? std::optional(command_from_json(text)) : std::nullopt;
}

std::filesystem::path caller_program() {
  if (const auto file = find_program("gigabake", GIGABAKE_FROM_BENCH)) return *file;
  const auto [built, installed] = program_folders(GIGABAKE_FROM_BENCH);
  throw std::runtime_error(fmt::format("bench: the program gigabake is neither in {} nor in {}; build or install both",
                                       built.string(), installed.string()));
}

std::optional<std::string> other_version_error(const std::string& caller) {
  if (caller == build_version()) return std::nullopt;
  return fmt::format("bench: {} has version {}, but gigabake has version {}; build or install both together",
                     program_name, build_version(), caller);
}

}  // namespace gigabake::app
