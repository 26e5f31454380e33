// Signatures of datagrams, with the clock of a link that Python uses, too. The cryptography is that of boards (cpp/c).
#pragma once

#include <algorithm>

#include "lock.hpp"
#include "roverlink/bridge.h"
#include "sending.hpp"
#include "times.hpp"

namespace roverlink {

constexpr uint8_t SIGNATURE = 15;  // bytes: key, timestamp and MAC
constexpr size_t SIGNATURE_ROOM = ROVERLINK_SIGNED_ANY;
constexpr int64_t TICK_NS = 1'000'000'000 / ROVERLINK_TICKS_PER_SECOND;
constexpr int64_t EPOCH_NS = 1'420'070'400'000'000'000;  // 2015-01-01 UTC

// As SigningClock.next: the computer's clock, which never goes back.
inline uint64_t next_timestamp(rl_clock &clock) {
  timespec wall;
  clock_gettime(CLOCK_REALTIME, &wall);
  const int64_t since_1970 = int64_t{wall.tv_sec} * 1'000'000'000 + wall.tv_nsec, steady = monotonic_ns() / TICK_NS;
  const Locked locked(*clock.lock);
  clock.now.offset = std::max(clock.now.offset, std::max<int64_t>(0, since_1970 - EPOCH_NS) / TICK_NS - steady);
  return roverlink_clock_next(&clock.now, static_cast<uint64_t>(steady));
}

inline void hear(rl_clock &clock, uint64_t timestamp) {
  const Locked locked(*clock.lock);
  roverlink_clock_hear(&clock.now, timestamp, static_cast<uint64_t>(monotonic_ns() / TICK_NS));
}

// Bytes of a signature's field: tag, length and signature.
inline size_t size_of_signature(uint32_t number) {
  size_t size = 1 + 1 + SIGNATURE;
  for (uint32_t rest = number >> 4; rest != 0; rest >>= 7) ++size;
  return size;
}

inline size_t without_zeros(const uint8_t *data, size_t size) {
  while (size > 0 && data[size - 1] == 0) --size;
  return size;
}

// Signs datagrams, behind which there is room for it, and sends them in order. Returns how many were sent, up to the
// first that could not be sent; the signatures of the others are worth nothing.
inline uint32_t send_signed(int socket, bool segments, const rl_signer &signer, const rl_datagram *datagrams,
                            uint32_t count) {
  if (socket < 0) return 0;
  rl_datagram made[MOST_TOGETHER];
  const Locked locked(*signer.lock);
  count = std::min(count, MOST_TOGETHER);
  for (uint32_t one = 0; one < count; ++one) {
    auto *const data = const_cast<uint8_t *>(datagrams[one].data);
    // The signature is of the whole envelope.
    const size_t whole = signer.strips_zeros ? roverlink_restore(data, datagrams[one].size, SIZE_MAX)
                                             : datagrams[one].size;
    const size_t size = roverlink_sign(&signer.key, signer.number, next_timestamp(*signer.clock), data, whole,
                                       whole + SIGNATURE_ROOM);
    made[one] = {data, signer.strips_zeros ? without_zeros(data, size) : size, nullptr, 0};
  }
  return send_all(socket, segments, made, count);
}

}  // namespace roverlink
