/// OUT/survey.cache: the surveys of the last bake, so that an unchanged tile is not read again.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <unordered_map>
#include <vector>

#include "format/job/survey.h"
#include "format/source/source.h"
#include "lattice/parameters.h"
#include "lattice/progress.h"

namespace gigabake {

/// Surveys by what they were made of: name, kind and placement of the tile, and the parameters that shape the lattice.
/// Exact   A survey is found only where every file that it was made of bears the settled stamp that it had before it
/// was
///         read (format/system/file_stamp.h), absent files included.
/// Errors  None: a file that is absent, damaged, cut or foreign has no surveys.
class SurveyCache {
 public:
  explicit SurveyCache(const std::filesystem::path& path);
  SurveyCache(const SurveyCache&) = delete;
  SurveyCache& operator=(const SurveyCache&) = delete;

  std::optional<TileSurvey> find(const SceneSources& sources, std::uint32_t tile,
                                 const BakeParameters& parameters) const;
  /// By tile. Cost  Opens each file: 10^5 tiles of two files in 0.4 s on two threads and a local disk.
  std::vector<std::optional<TileSurvey>> find_all(const SceneSources& sources, const BakeParameters& parameters,
                                                  int threads, const Progress& progress = {}) const;
  std::size_t size() const { return surveys_.size(); }

 private:
  struct LowHalf {
    std::size_t operator()(const Hash128& h) const { return std::size_t(h.lo); }
  };

  void load(const std::filesystem::path& path);

  std::vector<std::uint8_t> bytes_;
  std::unordered_map<Hash128, std::span<const std::uint8_t>, LowHalf> surveys_;  ///< in bytes_
};

/// Replaces the file by these surveys. Left out: those with an error, and those of files that were written so recently
/// that their stamps say nothing.
/// Errors  InputError: the file is as it was.
void save_survey_cache(const std::filesystem::path& path, const SceneSources& sources, const BakeParameters& parameters,
                       std::span<const TileSurvey> surveys);

}  // namespace gigabake
