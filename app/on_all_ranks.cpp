#include "app/on_all_ranks.h"

#include <fmt/core.h>

#include "app/commands.h"
#include "cluster/collective.h"
#include "format/error.h"

namespace gigabake::app {

int on_all_ranks(const std::function<int(MpiSession&)>& work) {
  MpiSession mpi;
  try {
    return mpi.from_master(work(mpi));
  } catch (const CollectiveFailure& e) {
    if (*e.what() != '\0') fmt::print(stderr, "gigabake: {}\n", e.what());
    return failed;
  } catch (const UsageError& e) {  // the arguments are the same on every rank
    if (mpi.rank() == 0) fmt::print(stderr, "gigabake: {}\n", e.what());
    return usage;
  } catch (const std::exception& e) {
    if (mpi.ranks() == 1) throw;
    fmt::print(stderr, "gigabake: rank {}: {}\n", mpi.rank(), e.what());
    mpi.abort(failed);  // this rank alone failed: the others would wait for it for ever
  }
}

}  // namespace gigabake::app
