// Members of structs that one thread writes and another one reads meanwhile.
#pragma once

#include <cstdint>

namespace roverlink {

template <typename T>
T load(const T &member) {
  return __atomic_load_n(&member, __ATOMIC_RELAXED);
}

template <typename T>
void store(T &member, T value) {
  __atomic_store_n(&member, value, __ATOMIC_RELAXED);
}

// Adds to a counter that only the calling thread writes.
inline void add(uint64_t &counter, uint64_t count) { store(counter, counter + count); }

}  // namespace roverlink
