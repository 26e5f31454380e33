// Ring of copies for observers: one thread writes, another one reads.
#pragma once

#include <algorithm>
#include <cstring>

#include "roverlink/bridge.h"

namespace roverlink {

struct Record {
  uint32_t size, channel;
  int64_t at;
};

// Bytes that a record with `size` bytes of data takes.
inline size_t room_of(size_t size) { return sizeof(Record) + ((size + 7) & ~size_t{7}); }

inline bool has_room(const rl_ring &ring, size_t bytes) {
  return bytes <= ring.room - (ring.written - __atomic_load_n(&ring.read, __ATOMIC_ACQUIRE));
}

inline void copy_in(rl_ring &ring, uint64_t place, const void *data, size_t size) {
  const size_t start = place % ring.room, first = std::min<size_t>(size, ring.room - start);
  std::memcpy(ring.memory + start, data, first);
  std::memcpy(ring.memory, static_cast<const uint8_t *>(data) + first, size - first);
}

// Adds a record, for which there must be room.
inline void put(rl_ring &ring, uint32_t channel, int64_t at, const uint8_t *data, size_t size) {
  const Record record = {static_cast<uint32_t>(size), channel, at};
  copy_in(ring, ring.written, &record, sizeof record);
  copy_in(ring, ring.written + sizeof record, data, size);
  __atomic_store_n(&ring.written, ring.written + room_of(size), __ATOMIC_RELEASE);
}

}  // namespace roverlink
