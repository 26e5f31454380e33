// Limit of the rate of a row.
#pragma once

#include <algorithm>

#include "lock.hpp"
#include "roverlink/bridge.h"
#include "shared_counts.hpp"
#include "times.hpp"

namespace roverlink {

enum class Turn { PASSES, WAITS, WAITS_ALREADY };

// Decides about a message that fits into the pacer's room, as Pacer.offer: it passes, or waits in the place of another.
inline Turn offer(rl_pacer &pacer, const uint8_t *message, size_t size) {
  const double now = static_cast<double>(monotonic_ns()) * 1e-9;
  const Locked locked(*pacer.lock);
  const bool other_waits = pacer.waits != 0;
  add(pacer.superseded, pacer.waits);
  pacer.waits = now < pacer.slot;
  if (pacer.waits == 0) {
    pacer.slot = now + pacer.interval;
    return Turn::PASSES;
  }
  std::copy(message, message + size, pacer.message);
  pacer.size = size;
  return other_waits ? Turn::WAITS_ALREADY : Turn::WAITS;
}

}  // namespace roverlink
