/// What a message between ranks means.
#pragma once

namespace gigabake {

enum Tag : int {
  tag_survey = 1,  ///< worker to master: one TileSurvey
  tag_job,         ///< master to worker: one CellJob
  tag_report,      ///< worker to master: one CellReport
  tag_stop,        ///< master to worker: no more jobs
};

}  // namespace gigabake
