/// The files that replace MPI and OpenEXR in builds with -DGIGABAKE_MPI=OFF and -DGIGABAKE_OPENEXR=OFF.
#include <gtest/gtest.h>
#include <stdexcept>

#include "cluster/mpi/mpi_session.h"
#include "cluster/mpi/mpi_version.h"
#include "format/system/host_limits.h"
#include "viewer/pictures/image_files.h"

namespace gigabake {
namespace {

TEST(WithoutMpiLibrary, ASessionIsAWorldOfOneRankWithAllCores) {
  MpiSession session;
  EXPECT_FALSE(has_mpi());
  EXPECT_EQ(session.rank(), 0);
  EXPECT_EQ(session.ranks(), 1);
  EXPECT_EQ(session.rank_on_host(), 0);
  EXPECT_EQ(session.ranks_on_host(), 1);
  EXPECT_EQ(session.cores(), host_limits().cores());
  EXPECT_GE(session.host_cores(), session.cores());
}

TEST(WithoutMpiLibrary, CollectiveCallsReturnTheOwnValueAndNoMessageArrives) {
  MpiSession session;
  EXPECT_EQ(session.max_of(-3), -3);
  EXPECT_EQ(session.sum_of(7), 7);
  EXPECT_EQ(session.from_master(5), 5);
  EXPECT_EQ(session.from_master(std::vector<std::uint8_t>{1, 2}), (std::vector<std::uint8_t>{1, 2}));
  session.progress();
  EXPECT_FALSE(session.poll());
  EXPECT_THROW(session.send(1, 0, {}), std::logic_error);
}

TEST(WithoutOpenExr, TheErrorNamesPackageAndOption) {
  const std::string error = missing_openexr_error().value();
  EXPECT_NE(error.find("libopenexr-dev"), std::string::npos);
  EXPECT_NE(error.find("-DGIGABAKE_OPENEXR=ON"), std::string::npos);
  EXPECT_THROW(encode_exr({}, ExrChannels::depth, 1), std::runtime_error);
  EXPECT_THROW(write_exr("p.exr", {}, ExrChannels::depth, 1), std::runtime_error);
}

}  // namespace
}  // namespace gigabake
