#include "app/edit/scene_editor.h"

#include <array>
#include <cerrno>
#include <fcntl.h>
#include <spawn.h>
#include <string>
#include <sys/wait.h>
#include <system_error>
#include <unistd.h>
#include <utility>
#include <vector>

#include "cluster/process/temporary_folder.h"
#include "core/base/error.h"
#include "format/edit/edit_json.h"
#include "format/edit/edits_in_scene.h"
#include "format/system/publish.h"

namespace gigabake::app {
namespace {

constexpr std::array<std::uint8_t, 3> carve_rgb{255, 60, 60}, class_rgb{150, 150, 150};

std::array<std::uint8_t, 3> shown_rgb(const Edit& edit) {
  if (edit.type == EditType::carve) return carve_rgb;
  return edit.has_rgb ? edit.rgb : class_rgb;
}

/// A pipe whose ends are closed with it.
struct Pipe {
  int ends[2] = {-1, -1};

  Pipe() {
    if (::pipe2(ends, O_CLOEXEC) != 0) throw std::system_error(errno, std::generic_category(), "pipe2");
  }
  ~Pipe() {
    close(0);
    close(1);
  }
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;
  void close(std::size_t end) {
    if (ends[end] >= 0) ::close(std::exchange(ends[end], -1));
  }
};

[[noreturn]] void fail(const char* call, int error) { throw std::system_error(error, std::generic_category(), call); }

/// Reads until the other end is closed.
std::string read_all(int descriptor) {
  std::string text;
  std::array<char, 4096> part;
  for (;;) {
    const ssize_t got = ::read(descriptor, part.data(), part.size());
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return text;
    text.append(part.data(), std::size_t(got));
  }
}

/// Returns the last line that reports an error of gigabake, without its prefix; else the whole text.
std::string error_line(const std::string& text) {
  constexpr std::string_view prefix = "gigabake: ";
  const std::size_t at = text.rfind("\n" + std::string(prefix));
  const std::size_t begin = at != std::string::npos ? at + 1 : 0;
  std::string line = text.substr(begin, text.find('\n', begin) - begin);
  if (line.starts_with(prefix)) line.erase(0, prefix.size());
  return line;
}

/// Runs the program and waits for its end.
/// Errors  InputError: the line that the program printed. std::system_error: it cannot be started.
void run(const std::filesystem::path& program, const std::vector<std::string>& arguments) {
  std::vector<std::string> words{std::filesystem::canonical(program).string()};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  Pipe messages;
  pid_t child = -1;
  posix_spawn_file_actions_t actions;
  ::posix_spawn_file_actions_init(&actions);
  ::posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  ::posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  ::posix_spawn_file_actions_adddup2(&actions, messages.ends[1], STDERR_FILENO);
  const int error = ::posix_spawn(&child, argv[0], &actions, nullptr, argv.data(), environ);
  ::posix_spawn_file_actions_destroy(&actions);
  if (error != 0) fail("posix_spawn", error);
  messages.close(1);
  const std::string said = read_all(messages.ends[0]);
  int status = 0;
  while (::waitpid(child, &status, 0) < 0)
    if (errno != EINTR) fail("waitpid", errno);
  if (WIFEXITED(status) && WEXITSTATUS(status) == 0) return;
  const std::string line = error_line(said);
  throw InputError("edit", "", line.empty() ? "ended without a message" : line);
}

class CommandEditor : public SceneEditor {
 public:
  CommandEditor(std::filesystem::path folder, std::filesystem::path program)
      : folder_(std::move(folder)), program_(std::move(program)) {}

  EditPreviews preview(const std::string& edits, const PictureRays& scene) const override {
    const auto list = std::make_shared<const EditList>(edits_from_json("edits", edits));
    const auto placed =
        std::make_shared<const EditsInScene>(list, scene.origin, SnapFrame{scene.voxel_size_m, scene.lattice_origin_m});
    EditPreviews out;
    for (std::uint32_t e = 0; e < placed->size(); ++e)
      out.push_back({placed->bounds(e), shown_rgb((*list)[e]),
                     [placed, e](const Vec3i64& voxel) { return placed->selects(e, voxel); }});
    return out;
  }

  void apply(const std::string& edits) override {
    const TemporaryFolder scratch;
    const std::filesystem::path file = scratch.path() / "edits.json";
    publish_file(file, edits);
    run(program_, {"edit", folder_.string(), "--from", file.string(), "--ranks", "1", "--quiet"});
  }

  void undo() override { run(program_, {"edit", folder_.string(), "--undo", "--ranks", "1", "--quiet"}); }

 private:
  const std::filesystem::path folder_, program_;
};

}  // namespace

std::shared_ptr<SceneEditor> make_scene_editor(const std::filesystem::path& folder,
                                               const std::filesystem::path& program) {
  return std::make_shared<CommandEditor>(folder, program);
}

}  // namespace gigabake::app
