#include "ring.hpp"

extern "C" size_t rl_take_records(rl_ring *ring, uint8_t *out) {
  const uint64_t written = __atomic_load_n(&ring->written, __ATOMIC_ACQUIRE);
  const size_t size = static_cast<size_t>(written - ring->read), start = ring->read % ring->room;
  const size_t first = std::min<size_t>(size, ring->room - start);
  std::memcpy(out, ring->memory + start, first);
  std::memcpy(out + first, ring->memory, size - first);
  __atomic_store_n(&ring->read, written, __ATOMIC_RELEASE);
  return size;
}

extern "C" void rl_newest_records(const uint8_t *records, size_t size, uint64_t *places) {
  roverlink::Record record;
  for (size_t place = 0; place < size; place += roverlink::room_of(record.size)) {
    std::memcpy(&record, records + place, sizeof record);
    places[record.channel & ~RL_RAW] = place + 1;
  }
}
