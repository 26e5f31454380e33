// The lock for threads of Python.
#include "lock.hpp"

extern "C" {

void rl_lock_take(rl_lock *lock) { roverlink::take(*lock); }

int rl_lock_try(rl_lock *lock) { return roverlink::try_to_take(*lock); }

void rl_lock_leave(rl_lock *lock) { roverlink::leave(*lock); }

}  // extern "C"
