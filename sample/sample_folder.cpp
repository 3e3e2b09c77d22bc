#include "sample/sample_folder.h"

#include <fstream>
#include <string>

#include "core/base/error.h"

namespace gigabake::sample {
namespace {

namespace fs = std::filesystem;

constexpr char temporary_name[] = ".unfinished-gigabake-sample", tileset_name[] = "tileset.json";
constexpr const char* tile_folders[] = {"tiles", "local"};
constexpr char texture_folder[] = "textures";

[[noreturn]] void fail(const fs::path& path, const char* what, const std::error_code& error) {
  throw InputError(path, "", std::string(what) + ": " + error.message());
}

bool is_sample(const fs::path& tileset) {
  std::ifstream in(tileset, std::ios::binary);
  std::string head(256, '\0');
  in.read(head.data(), std::streamsize(head.size()));
  return head.find(sample_generator) != std::string::npos;
}

/// Rejects a folder with a sample or other content, so that nothing is overwritten. Files of a killed run identify the
/// folder of an unfinished sample.
void check_ours(const fs::path& dir) {
  std::error_code error;
  const auto refuse = [&] { throw InputError(dir, "", "exists and is not a sample; name a new or empty folder"); };
  if (!fs::is_directory(dir, error)) refuse();
  if (is_sample(dir / tileset_name))
    throw InputError(dir, "", "holds a sample already; remove it, or name a new or empty folder");
  if (fs::exists(dir / temporary_name, error)) return;
  const bool empty = fs::is_empty(dir, error);
  if (error) fail(dir, "cannot list the folder", error);
  if (!empty) refuse();
}

void clear(const fs::path& path) {
  std::error_code error;
  fs::remove_all(path, error);
  if (error) fail(path, "cannot be removed", error);
}

}  // namespace

SampleFolder::SampleFolder(const fs::path& dir) : dir_(dir), temporary_(dir / temporary_name) {
  std::error_code error;
  if (fs::exists(dir, error))
    check_ours(dir);
  else
    made_dir_ = true;
  clear(temporary_);
  for (const char* folder : tile_folders) {
    fs::create_directories(temporary_ / folder / texture_folder, error);
    if (!error) continue;
    discard();
    fail(temporary_ / folder, "cannot make the folder", error);
  }
}

SampleFolder::~SampleFolder() { discard(); }

void SampleFolder::discard() {
  std::error_code ignored;
  fs::remove_all(temporary_, ignored);
  if (made_dir_) fs::remove(dir_, ignored);  // fails if the folder is not empty
}

void SampleFolder::publish() {
  // Removes tileset.json first, so that concurrent readers find no sample instead of a partial one.
  clear(dir_ / tileset_name);
  for (const char* name : {tile_folders[0], tile_folders[1], tileset_name}) {
    clear(dir_ / name);
    std::error_code error;
    fs::rename(temporary_ / name, dir_ / name, error);
    if (error) fail(dir_ / name, "cannot be renamed into place", error);
  }
}

}  // namespace gigabake::sample
