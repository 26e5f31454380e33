// Clocks.
#pragma once

#include <time.h>

#include <cstdint>

namespace roverlink {

// Time of the clock that Python's time.monotonic() shows.
inline int64_t monotonic_ns() {
  timespec now;
  clock_gettime(CLOCK_MONOTONIC, &now);
  return int64_t{now.tv_sec} * 1'000'000'000 + now.tv_nsec;
}

}  // namespace roverlink
