#include "cluster/survey.h"

#include <chrono>
#include <thread>

#include "cluster/tags.h"
#include "format/cell_job.h"
#include "worker/survey_tile.h"

namespace gigabake {

std::vector<TileSurvey> survey_tiles(MpiSession& mpi, const SceneSources& sources, const BakeParameters& parameters,
                                     int threads) {
  const kernels::CpuPolicy policy(threads);
  const auto tiles = std::uint32_t(sources.tiles.size());
  std::vector<TileSurvey> surveys;
  for (auto tile = std::uint32_t(mpi.rank()); tile < tiles; tile += std::uint32_t(mpi.ranks())) {
    TileSurvey survey = survey_tile(sources, tile, parameters, policy);
    if (mpi.rank() == 0)
      surveys.push_back(std::move(survey));
    else
      mpi.send(0, tag_survey, to_bytes(survey));
    // Taken in between, so that no rank's messages pile up.
    while (mpi.rank() == 0 && surveys.size() < tiles) {
      const auto message = mpi.poll();
      if (!message) break;
      surveys.push_back(survey_from_bytes(message->bytes));
    }
  }
  while (mpi.rank() == 0 && surveys.size() < tiles) {
    if (const auto message = mpi.poll())
      surveys.push_back(survey_from_bytes(message->bytes));
    else
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return surveys;
}

}  // namespace gigabake
