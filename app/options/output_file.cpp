#include "app/options/output_file.h"

#include <algorithm>
#include <fmt/format.h>
#include <fstream>

#include "core/base/error.h"
#include "core/base/quote.h"
#include "format/system/path_within.h"

namespace gigabake::app {
namespace {

namespace fs = std::filesystem;

/// Returns the absolute path with links resolved. The path need not exist.
fs::path plain(const fs::path& path) {
  std::error_code error;
  const fs::path p = fs::weakly_canonical(fs::absolute(path, error), error);
  return p.has_filename() ? p : p.parent_path();
}

bool is_at_or_below(const fs::path& path, const fs::path& folder) { return is_within(plain(folder), plain(path)); }

/// Returns true if a file in `folder` is the same file as `file` under another name.
bool has_hard_link_in(const fs::path& folder, const fs::path& file) {
  std::error_code error, ignored;
  for (fs::recursive_directory_iterator it(folder, error), end; !error && it != end; it.increment(error))
    if (it->is_regular_file(ignored) && fs::equivalent(it->path(), file, ignored)) return true;
  return false;
}

bool is_part_of(const fs::path& file, const fs::path& input) {
  std::error_code error;
  if (is_at_or_below(file, input) || fs::equivalent(file, input, error)) return true;
  const bool has_other_names = fs::hard_link_count(file, error) > 1 && !error;
  return has_other_names && fs::is_directory(input, error) && has_hard_link_in(input, file);
}

[[noreturn]] void refuse(const char* option, const std::string& name, const std::string& why) {
  throw InputError(name, option, why);
}

}  // namespace

void expect_no_input(const char* option, const std::string& name, const std::vector<fs::path>& inputs) {
  if (name.empty()) return;
  std::error_code error;
  if (fs::exists(name, error) && !fs::is_regular_file(name, error)) refuse(option, name, "is no regular file");
  for (const fs::path& input : inputs)
    if (!input.empty() && is_part_of(name, input))
      refuse(option, name,
             plain(name) == plain(input) ? "is a file that the command reads or keeps; name another file"
                                         : "belongs to " + short_path(input.string()) + "; name another file");
}

void expect_parent_folder(const char* option, const std::string& name, const fs::path& made) {
  if (name.empty()) return;
  const fs::path path = name, folder = (path.has_filename() ? path : path.parent_path()).parent_path();
  std::error_code error;
  if (folder.empty() || fs::is_directory(folder, error)) return;
  if (!made.empty() && plain(folder) == plain(made)) return;
  refuse(option, name,
         fs::exists(folder, error) ? "its folder is a file" : "its folder does not exist; make it first (mkdir -p)");
}

void expect_own_file(const char* option, const std::string& name, std::string_view beginning,
                     const std::vector<fs::path>& inputs) {
  expect_no_input(option, name, inputs);
  std::error_code error;
  if (name.empty() || !fs::exists(name, error) || fs::file_size(name, error) == 0) return;
  std::string head(beginning.size(), '\0');
  std::ifstream(name, std::ios::binary).read(head.data(), std::streamsize(head.size()));
  if (head != beginning)
    refuse(option, name, "exists and was not written by this option; remove it, or name another file");
}

std::vector<fs::path> files_of_bake(const fs::path& out) {
  std::vector<fs::path> files;
  for (const char* name : {"scene.xml", "journal", ".lock", "plan", "survey.cache", "status.json", "edits.json",
                           "source.json", "shards", "pages", "scratch"})
    files.push_back(out / name);
  return files;
}

}  // namespace gigabake::app
