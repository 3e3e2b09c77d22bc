/// The parallel survey: every rank looks at its share of the tiles, rank 0 collects.
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "cluster/mpi_session.h"
#include "format/parameters.h"
#include "format/source.h"
#include "format/survey.h"

namespace gigabake {

/// Collective. One survey per tile on rank 0, nothing elsewhere. A tile that cannot be read is a survey with an error.
/// on_survey: rank 0's; how many surveys are there.
std::vector<TileSurvey> survey_tiles(MpiSession& mpi, const SceneSources& sources, const BakeParameters& parameters,
                                     int threads, const std::function<void(std::size_t)>& on_survey);

}  // namespace gigabake
