#include "cluster/dispatch/sent_children.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace gigabake {
namespace {

using testing::IsEmpty;

/// Returns four cells and two overviews; cell 1 is a child of both.
std::vector<CellJob> family() {
  std::vector<CellJob> jobs(6);
  for (std::uint32_t j = 0; j < jobs.size(); ++j) jobs[j].id = j;
  jobs[4].first_lod = jobs[5].first_lod = 3;
  jobs[4].children = {0, 1};
  jobs[5].children = {1, 2, 3};
  return jobs;
}

CellReport report_of(std::uint32_t job) {
  CellReport report;
  report.id = job;
  report.cell.file = "shards/" + std::to_string(job) + ".h5";
  return report;
}

std::vector<std::string> files(const std::vector<ChildBytes>& children) {
  std::vector<std::string> names;
  for (const ChildBytes& child : children) names.push_back(child.file + ":" + std::to_string(child.bytes.size()));
  return names;
}

TEST(SentChildren, GoToTheWorkerThatDidNotBakeThem) {
  const std::vector<CellJob> jobs = family();
  SentChildren sent(jobs);
  for (std::uint32_t job = 0; job < 4; ++job)
    sent.keep(int(job % 2), report_of(job), std::vector<std::uint8_t>(job + 1));
  EXPECT_THAT(files(sent.take_for(4, 0)), testing::ElementsAre("shards/1.h5:2"));
  EXPECT_THAT(files(sent.take_for(5, 1)), testing::ElementsAre("shards/2.h5:3"));
}

TEST(SentChildren, AChildOfTwoOverviewsGoesToBothAndNoChildTwice) {
  const std::vector<CellJob> jobs = family();
  SentChildren sent(jobs);
  for (const std::uint32_t job : {0u, 1u}) sent.keep(0, report_of(job), {1, 2, 3});
  EXPECT_THAT(files(sent.take_for(4, 1)), testing::ElementsAre("shards/0.h5:3", "shards/1.h5:3"));
  EXPECT_THAT(files(sent.take_for(5, 1)), testing::ElementsAre("shards/1.h5:3"));
  EXPECT_THAT(sent.take_for(4, 1), IsEmpty()) << "a second attempt reads shards";
  sent.keep(0, report_of(1), {1, 2, 3});
  EXPECT_THAT(sent.take_for(5, 1), IsEmpty()) << "nothing is kept that no overview will take";
}

TEST(SentChildren, StayWithinTheirMemory) {
  const std::vector<CellJob> jobs = family();
  SentChildren sent(jobs, 5);
  sent.keep(0, report_of(0), {1, 2, 3});
  sent.keep(0, report_of(1), {1, 2, 3});
  EXPECT_THAT(files(sent.take_for(4, 1)), testing::ElementsAre("shards/0.h5:3"));
  sent.keep(0, report_of(2), {1, 2, 3, 4, 5});
  EXPECT_THAT(files(sent.take_for(5, 1)), testing::ElementsAre("shards/2.h5:5"));
}

TEST(SentChildren, NothingIsKeptOfAChildWithoutData) {
  const std::vector<CellJob> jobs = family();
  SentChildren sent(jobs);
  sent.keep(0, report_of(0), {});
  EXPECT_THAT(sent.take_for(4, 1), IsEmpty());
}

}  // namespace
}  // namespace gigabake
