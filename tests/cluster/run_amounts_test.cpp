/// The amounts of a run: area by columns of cells, and sums over reports.
#include "cluster/bake/run_amounts.h"

#include <gtest/gtest.h>

namespace gigabake {
namespace {

class RunAmountsTest : public testing::Test {
 protected:
  RunAmountsTest() {
    plan_.jobs = {cell(0, 0, 0, 0), cell(1, 64, 0, 0), cell(2, 0, 0, 64), cell(3, 0, 0, 0)};
    plan_.jobs[3].first_lod = 4;  // an overview
    plan_.bounds = {{16, 0, 0}, {84, 50, 128}};
  }
  static CellJob cell(std::uint32_t id, std::int64_t x, std::int64_t y, std::int64_t z) {
    CellJob job;
    job.id = id;
    job.lattice_min = {x, y, z};
    job.cell_voxels = 64;
    return job;
  }

  static CellReport baked(std::uint32_t id, std::uint64_t triangles, std::vector<std::uint64_t> voxels,
                          std::uint64_t bytes) {
    CellReport report;
    report.id = id;
    report.outcome = CellOutcome::baked;
    report.cell.triangles = triangles;
    report.cell.voxels = std::move(voxels);
    report.cell.bytes = bytes;
    return report;
  }

  BakePlan plan_;
};

TEST_F(RunAmountsTest, CountAStackOfCellsOnceAndOnlyWithinTheBounds) {
  const std::vector<CellReport> reports{baked(0, 1, {}, 0), baked(2, 1, {}, 0), baked(1, 1, {}, 0), baked(3, 0, {}, 0)};
  EXPECT_DOUBLE_EQ(amounts_of(plan_, reports, 2).square_km, (48.0 + 20.0) * 50.0 * 4.0 * 1e-6);
}

TEST_F(RunAmountsTest, AreSumsOverTheReports) {
  CellReport overview = baked(3, 0, {9, 2}, 5);
  overview.cell.copied_lods = 1;
  const RunAmounts amounts = amounts_of(plan_, {baked(0, 10, {100, 20}, 1000), baked(1, 7, {3}, 100), overview}, 1);
  EXPECT_EQ(amounts.triangles, 17u);
  EXPECT_EQ(amounts.voxels, 125u);
  EXPECT_EQ(amounts.bytes, 1105u);
}

TEST_F(RunAmountsTest, LeaveOutCellsThatFailed) {
  CellReport failed = baked(0, 10, {100}, 1000);
  failed.outcome = CellOutcome::failed;
  const RunAmounts amounts = amounts_of(plan_, {failed}, 1);
  EXPECT_EQ(amounts.square_km, 0);
  EXPECT_EQ(amounts.voxels, 0u);
}

}  // namespace
}  // namespace gigabake
