#include "cluster/survey.h"

#include <chrono>
#include <thread>

#include "cluster/tags.h"
#include "format/cell_job.h"
#include "worker/survey_tile.h"

namespace gigabake {
namespace {

/// Takes what has arrived; false when nothing had.
bool collect(MpiSession& mpi, std::vector<TileSurvey>& surveys) {
  const std::size_t before = surveys.size();
  while (const auto message = mpi.poll()) surveys.push_back(survey_from_bytes(message->bytes));
  return surveys.size() != before;
}

}  // namespace

std::vector<TileSurvey> survey_tiles(MpiSession& mpi, const SceneSources& sources, const BakeParameters& parameters,
                                     int threads, const std::function<void(std::size_t)>& on_survey) {
  const kernels::CpuPolicy policy(threads);
  const auto tiles = std::uint32_t(sources.tiles.size());
  std::vector<TileSurvey> surveys;
  for (auto tile = std::uint32_t(mpi.rank()); tile < tiles; tile += std::uint32_t(mpi.ranks())) {
    TileSurvey survey = survey_tile(sources, tile, parameters, policy);
    if (mpi.rank() != 0) {
      mpi.send(0, tag_survey, to_bytes(survey));
      continue;
    }
    surveys.push_back(std::move(survey));
    collect(mpi, surveys);
    on_survey(surveys.size());
  }
  while (mpi.rank() == 0 && surveys.size() < tiles) {
    if (collect(mpi, surveys))
      on_survey(surveys.size());
    else
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return surveys;
}

}  // namespace gigabake
