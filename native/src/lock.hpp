// Lock that threads of Python take, too. A mutex of pthread would need a newer system to be tried without waiting.
#pragma once

#include <linux/futex.h>
#include <sys/syscall.h>
#include <unistd.h>

#include "roverlink/bridge.h"

namespace roverlink {

enum : uint32_t { FREE, TAKEN, WANTED };  // WANTED: taken, and another thread may sleep until it is free

inline bool try_to_take(rl_lock &lock) {
  uint32_t expected = FREE;
  return __atomic_compare_exchange_n(&lock.state, &expected, TAKEN, false, __ATOMIC_ACQUIRE, __ATOMIC_RELAXED);
}

inline void take(rl_lock &lock) {
  if (try_to_take(lock)) return;
  while (__atomic_exchange_n(&lock.state, WANTED, __ATOMIC_ACQUIRE) != FREE)
    syscall(SYS_futex, &lock.state, FUTEX_WAIT_PRIVATE, WANTED, nullptr);
}

inline void leave(rl_lock &lock) {
  if (__atomic_exchange_n(&lock.state, FREE, __ATOMIC_RELEASE) == WANTED)
    syscall(SYS_futex, &lock.state, FUTEX_WAKE_PRIVATE, 1);
}

class Locked {
 public:
  explicit Locked(rl_lock &lock) : lock_(lock) { take(lock_); }
  ~Locked() { leave(lock_); }
  Locked(const Locked &) = delete;
  Locked &operator=(const Locked &) = delete;

 private:
  rl_lock &lock_;
};

}  // namespace roverlink
