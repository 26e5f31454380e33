// Mutex that threads of Python take, too.
#pragma once

#include <pthread.h>

#include "roverlink/bridge.h"

struct rl_lock {
  pthread_mutex_t mutex;
};

namespace roverlink {

class Locked {
 public:
  explicit Locked(rl_lock &lock) : mutex_(lock.mutex) { pthread_mutex_lock(&mutex_); }
  ~Locked() { pthread_mutex_unlock(&mutex_); }
  Locked(const Locked &) = delete;
  Locked &operator=(const Locked &) = delete;

 private:
  pthread_mutex_t &mutex_;
};

}  // namespace roverlink
