/// The parallel survey: every rank looks at its share of the tiles, rank 0 collects.
#pragma once

#include <vector>

#include "cluster/mpi_session.h"
#include "format/parameters.h"
#include "format/source.h"
#include "format/survey.h"

namespace gigabake {

/// Collective. One survey per tile on rank 0, nothing elsewhere. A tile that cannot be read is a survey with an error.
std::vector<TileSurvey> survey_tiles(MpiSession& mpi, const SceneSources& sources, const BakeParameters& parameters,
                                     int threads);

}  // namespace gigabake
