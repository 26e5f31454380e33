// Locks, and the C code of boards, of which the library has a copy of its own.
#include "signing.hpp"

#include <cstdlib>

#ifndef __clang__  // GCC unrolls the rounds of the hash only so: they then take less than half the time
#pragma GCC optimize("O3")
#endif
#include "roverlink_signing.c"

extern "C" {

rl_lock *rl_lock_new(void) {
  auto *lock = static_cast<rl_lock *>(std::malloc(sizeof(rl_lock)));
  if (lock != nullptr) pthread_mutex_init(&lock->mutex, nullptr);
  return lock;
}

void rl_lock_take(rl_lock *lock) { pthread_mutex_lock(&lock->mutex); }

int rl_lock_try(rl_lock *lock) { return pthread_mutex_trylock(&lock->mutex) == 0; }

void rl_lock_leave(rl_lock *lock) { pthread_mutex_unlock(&lock->mutex); }

}  // extern "C"
