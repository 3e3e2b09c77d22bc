#include "worker/device/backend.h"

#include <gtest/gtest.h>

#include "core/base/error.h"
#include "kernels/cuda/baker.h"

namespace gigabake {
namespace {

TEST(ChooseDevice, TakesNoneForTheCpu) {
  const DeviceChoice choice = choose_device({Backend::cpu, {}, 0});
  EXPECT_FALSE(choice.device);
  EXPECT_TRUE(choice.reason.empty());
}

TEST(SharersOfDevice, AreTheRanksThatTakeItInTurn) {
  for (int devices = 1; devices < 6; ++devices)
    for (int ranks = 1; ranks < 14; ++ranks)
      for (int rank = 0; rank < ranks; ++rank) {
        int takers = 0;
        for (int other = 0; other < ranks; ++other) takers += other % devices == rank % devices;
        EXPECT_EQ(sharers_of_device(rank, ranks, devices), takers) << rank << " of " << ranks << ", " << devices;
      }
}

TEST(ChooseDevice, SaysWhyThereIsNone) {
  if (!kernels::cuda_devices().usable.empty()) GTEST_SKIP() << "this machine has a CUDA device";
  EXPECT_FALSE(choose_device({Backend::automatic, {}, 0}).device);
  EXPECT_FALSE(choose_device({Backend::automatic, {}, 0}).reason.empty());
  EXPECT_THROW(choose_device({Backend::cuda, {}, 0}), InputError);
}

TEST(ChooseDevice, GivesRanksTheDevicesInTurn) {
  const std::vector<int> usable = kernels::cuda_devices().usable;
  if (usable.empty()) GTEST_SKIP() << kernels::cuda_devices().reason;
  for (int rank = 0; rank < 5; ++rank) {
    EXPECT_EQ(choose_device({Backend::automatic, {}, rank}).device, usable[std::size_t(rank) % usable.size()]);
    EXPECT_EQ(choose_device({Backend::cuda, {usable[0]}, rank}).device, usable[0]);
  }
  EXPECT_THROW(choose_device({Backend::cuda, {999}, 0}), UsageError);
}

}  // namespace
}  // namespace gigabake
