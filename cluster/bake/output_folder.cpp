#include "cluster/bake/output_folder.h"

#include <algorithm>
#include <string>
#include <string_view>
#include <unordered_set>
#include <utility>

#include "cluster/edit/scene_edits.h"
#include "core/base/error.h"
#include "core/base/quote.h"
#include "format/scene/xml/page_write.h"
#include "format/system/path_within.h"
#include "format/system/publish.h"
#include "format/system/publish_place.h"
#include "scheduler/status/bake_status.h"

namespace gigabake {
namespace {

namespace fs = std::filesystem;

/// Returns the absolute path without links, dots and a trailing slash. The path need not exist.
fs::path plain(const fs::path& path) {
  const fs::path p = fs::weakly_canonical(fs::absolute(path));
  return p.has_filename() ? p : p.parent_path();
}

bool is_at_or_below(const fs::path& path, const fs::path& folder) { return is_within(plain(folder), plain(path)); }

/// Returns true for names that begin like a cell ("c_X_Y_Z") or an overview ("pL_X_Y_Z").
bool begins_as_a_shard(std::string_view name) {
  return name.starts_with("c_") || (name.size() > 1 && name[0] == 'p' && name[1] >= '0' && name[1] <= '9');
}

/// Returns true for the temporary name of each file that a bake publishes in OUT and its subfolders.
bool is_temporary_file(const std::string& name) {
  const std::optional<std::string> target = target_of_temporary(name);
  if (!target) return false;
  const bool is_in_out = *target == "scene.xml" || fs::path(*target) == status_file({}) ||
                         fs::path(*target) == journal_of({}) || fs::path(*target) == scan_cache_of({}) ||
                         fs::path(*target) == plan_file_of({}) || fs::path(*target) == edits_file_of({}) ||
                         fs::path(*target) == source_file_of({});
  return is_in_out || begins_as_a_shard(*target) || target->starts_with("g_");
}

template <class Wanted>
std::vector<fs::path> files_in(const fs::path& folder, const Wanted& wanted) {
  std::error_code error;  // unreadable entries are ignored
  std::vector<fs::path> found;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error))
    if (wanted(it->path().filename().string())) found.push_back(it->path());
  return found;
}

std::vector<fs::path> find_orphans(const fs::path& out, const SceneDescription& scene) {
  std::unordered_set<std::string> used;
  for (const auto& shards : {&scene.cells, &scene.overviews})
    for (const SceneCell& c : *shards) used.insert(fs::path(c.file).filename().string());
  return files_in(out / "shards", [&](const std::string& name) {
    return begins_as_a_shard(name) && name.ends_with(".h5") && !used.contains(name);
  });
}

/// Refuses links under the names of files that a bake writes in place, because a link may lead to another user's file.
void expect_no_links(const fs::path& out) {
  for (const char* name : {".lock", "journal"}) {
    const fs::path path = out / name;
    std::error_code error;
    const fs::file_status status = fs::symlink_status(path, error);
    if (!fs::exists(status)) continue;
    const bool is_plain = fs::is_regular_file(status) && fs::hard_link_count(path, error) == 1;
    if (!is_plain)
      throw InputError(path, "",
                       "is a link to another file, or no file, and a bake writes there; remove it, or choose another "
                       "output folder");
  }
}

}  // namespace

OutputFolder::NewFolders::~NewFolders() {
  std::error_code error;  // a folder that is not empty stays
  for (; !made_.empty(); made_.pop_back()) fs::remove(made_.back(), error);
}

void OutputFolder::NewFolders::make(const fs::path& folder) {
  std::error_code error;
  std::vector<fs::path> missing;
  for (fs::path p = folder; !p.empty() && !fs::exists(p, error); p = p.parent_path()) missing.push_back(p);
  made_.insert(made_.end(), missing.rbegin(), missing.rend());
  fs::create_directories(folder, error);
  if (error) throw InputError(folder, "", "cannot make the output folder: " + error.message());
}

OutputFolder::OutputFolder(fs::path out, const fs::path& source) : out_(std::move(out)) {
  if (fs::is_directory(source) && is_at_or_below(out_, source))
    throw InputError(out_, "",
                     "lies in the source folder; choose an output folder outside of " + short_path(source.string()));
  folders_.make(out_);
  expect_no_links(out_);
  lock_.emplace(out_);
  folders_.make(out_ / "shards");
  remove_temporary_files();
  const Publication scene(out_ / "scene.xml"), shard(out_ / "shards" / "c_0_0_0.h5");  // throw early if unwritable
}

OutputFolder::~OutputFolder() { remove_temporary_files(); }

void OutputFolder::expect_shards(SceneDescription& scene) const {
  const auto is_there = [this](const SceneCell& cell) {
    std::error_code error;
    return fs::file_size(out_ / cell.file, error) == cell.bytes && !error;
  };
  for (std::vector<SceneCell>* shards : {&scene.cells, &scene.overviews}) {
    const auto gone = std::stable_partition(shards->begin(), shards->end(), is_there);
    for (auto cell = gone; cell != shards->end(); ++cell)
      scene.losses.push_back(
          {(cell->first_lod == 0 ? "cell " : "parent ") + cell->name,
           cell->file + " is not in " + short_path(out_.string()) + "; every host must see the same output folder"});
    shards->erase(gone, shards->end());
  }
}

bool OutputFolder::has_whole_scene() const {
  std::error_code error;
  if (!fs::is_regular_file(out_ / "scene.xml", error)) return false;
  try {
    return read_scene(out_ / "scene.xml").losses.empty();
  } catch (const InputError&) {
    return false;
  }
}

/// Keeps the pages of the replaced scene until the next publication: viewers that show it read them to find the
/// changed cells.
void OutputFolder::publish(const SceneDescription& scene) const {
  PageNames previous;
  try {
    previous = page_names(out_ / "scene.xml");
  } catch (const InputError&) {
    // There is no previous scene, or no viewer can show it.
  }
  write_scene(out_ / "scene.xml", scene);
  remove_unused_pages(out_ / "scene.xml", previous);
  remove_temporary_files();
}

void OutputFolder::remove_temporary_files() const {
  std::error_code error;  // failures to remove files are harmless
  for (const fs::path& folder : {out_, out_ / "shards", out_ / "pages"})
    for (const fs::path& path : files_in(folder, is_temporary_file)) fs::remove(path, error);
}

OrphanShards OutputFolder::orphans(const SceneDescription& scene) const {
  OrphanShards all;
  for (const fs::path& path : find_orphans(out_, scene)) {
    std::error_code error;
    const std::uint64_t bytes = fs::file_size(path, error);
    if (error) continue;
    ++all.files;
    all.bytes += bytes;
  }
  return all;
}

OrphanShards OutputFolder::remove_orphans(const SceneDescription& scene) const {
  OrphanShards gone;
  for (const fs::path& path : find_orphans(out_, scene)) {
    std::error_code size_error, error;
    const std::uint64_t bytes = fs::file_size(path, size_error);
    if (!fs::remove(path, error) || error) continue;
    ++gone.files;
    gone.bytes += size_error ? 0 : bytes;
  }
  return gone;
}

void expect_output_folder(const fs::path& out) {
  std::error_code error;
  if (!fs::is_directory(out / "shards", error))
    throw InputError(out / "shards", "", "does not exist on this host; every host must see the same output folder");
}

}  // namespace gigabake
