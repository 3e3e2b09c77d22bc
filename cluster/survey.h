/// The parallel survey: every rank's bake process looks at its share of the tiles, rank 0 collects.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "cluster/bake_process.h"
#include "cluster/mpi_session.h"
#include "format/job/survey.h"

namespace gigabake {

/// Surveys these tiles in the rank's own bake process. A tile at which the process dies is tried alone, three times in
/// all; then its survey is an error that says how the process ended.
/// each: a survey as it comes; died: the process ended, and why; idle: called between, at least every few milliseconds;
/// false: no more surveys. Errors  std::runtime_error: the process ends again and again before it has started.
void survey_here(BakeProcess& process, const std::vector<std::uint32_t>& tiles,
                 const std::function<void(TileSurvey)>& each, const std::function<void(const std::string&)>& died,
                 const std::function<bool()>& idle);

/// What rank 0 hears while tiles are surveyed.
struct SurveyListener {
  std::function<bool(std::size_t)> surveyed;               ///< how many surveys are there; false: no rank surveys more
  std::function<void(int rank, const std::string&)> died;  ///< a rank's bake process ended, and why
};

/// Collective. tiles: rank 0's; those to survey. One survey per tile on rank 0, nothing elsewhere. A tile that cannot
/// be read is a survey with an error. silence_s: rank 0 does not wait longer for a rank that says nothing.
/// listener: rank 0's. If it wants no more surveys, those that are there are returned.
/// Errors  RankLost on rank 0: a rank fell silent. No collective call may follow.
std::vector<TileSurvey> survey_tiles(MpiSession& mpi, const std::vector<std::uint32_t>& tiles, BakeProcess& process,
                                     double silence_s, const SurveyListener& listener);

}  // namespace gigabake
