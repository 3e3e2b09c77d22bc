#include "format/source/raster/proj_files.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <ogr_srs_api.h>
#include <proj.h>
#include <sstream>
#include <string>
#include <vector>

#include "format/system/path_within.h"

namespace gigabake {
namespace {

using Path = std::filesystem::path;

/// Returns the folders of PROJ, which proj_info() lists separated by colons. The first call must precede the
/// installation of the functions below, because proj_info() may itself open a file.
const std::vector<Path>& folders_of_proj() {
  static const std::vector<Path> folders = [] {
    std::vector<Path> out;
    std::istringstream list(proj_info().searchpath);
    for (std::string folder; std::getline(list, folder, ':');) {
      std::error_code error;
      const Path canonical = std::filesystem::weakly_canonical(folder, error);
      if (!folder.empty() && !error) out.push_back(canonical);
    }
    return out;
  }();
  return folders;
}

bool is_of_proj(const char* name) {
  std::error_code error;
  const Path file = std::filesystem::weakly_canonical(std::filesystem::absolute(name, error), error);
  return !error && std::ranges::any_of(folders_of_proj(), [&](const Path& folder) { return is_within(folder, file); });
}

std::FILE* stream(PROJ_FILE_HANDLE* file) { return reinterpret_cast<std::FILE*>(file); }

PROJ_FILE_HANDLE* open_file(PJ_CONTEXT*, const char* name, PROJ_OPEN_ACCESS access, void*) {
  if (access != PROJ_OPEN_ACCESS_READ_ONLY || !is_of_proj(name)) return nullptr;
  return reinterpret_cast<PROJ_FILE_HANDLE*>(std::fopen(name, "rb"));
}

std::size_t read_file(PJ_CONTEXT*, PROJ_FILE_HANDLE* file, void* to, std::size_t bytes, void*) {
  return std::fread(to, 1, bytes, stream(file));
}

std::size_t write_file(PJ_CONTEXT*, PROJ_FILE_HANDLE*, const void*, std::size_t, void*) { return 0; }

int seek_file(PJ_CONTEXT*, PROJ_FILE_HANDLE* file, long long offset, int whence, void*) {
  return ::fseeko(stream(file), off_t(offset), whence) == 0 ? 1 : 0;
}

unsigned long long tell_file(PJ_CONTEXT*, PROJ_FILE_HANDLE* file, void*) {
  return static_cast<unsigned long long>(::ftello(stream(file)));
}

void close_file(PJ_CONTEXT*, PROJ_FILE_HANDLE* file, void*) { std::fclose(stream(file)); }

int file_exists(PJ_CONTEXT*, const char* name, void*) {
  std::error_code error;
  return is_of_proj(name) && std::filesystem::exists(name, error) ? 1 : 0;
}

int refuse(PJ_CONTEXT*, const char*, void*) { return 0; }
int refuse_rename(PJ_CONTEXT*, const char*, const char*, void*) { return 0; }

}  // namespace

void confine_files(PJ_CONTEXT* context) {
  static const PROJ_FILE_API files{1,          open_file,   read_file, write_file, seek_file,    tell_file,
                                   close_file, file_exists, refuse,    refuse,     refuse_rename};
  folders_of_proj();
  proj_context_set_fileapi(context, &files, nullptr);
  proj_context_set_enable_network(context, 0);
}

void confine_proj() {
  confine_files(nullptr);  // the default context
  OSRSetPROJEnableNetwork(0);
}

}  // namespace gigabake
