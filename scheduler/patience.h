/// How long a bake waits before it takes somebody who does nothing for lost. From the parser to those who wait.
#pragma once

namespace gigabake {

struct Patience {
  /// Of a bake process with something in hand: no CPU time used, nothing read or written and no message for so long is
  /// a hang.
  double stall_s = 60;
  /// Longest time for one cell, or one survey, from when it is the oldest in hand.
  double cell_timeout_s = 3600;
  /// A rank that nothing is heard of for longer is lost.
  double silence_s = 60;
};

}  // namespace gigabake
