// Memory that frees itself. Not by `new`: what C++ needs to throw an exception would need a newer system.
#pragma once

#include <cstdlib>
#include <memory>

namespace roverlink {

struct Free {
  void operator()(void *memory) const { std::free(memory); }
};

template <typename T>
using Memory = std::unique_ptr<T[], Free>;

// Null if there is not enough.
template <typename T>
Memory<T> memory_for(size_t count) {
  return Memory<T>(static_cast<T *>(std::malloc(count * sizeof(T))));
}

}  // namespace roverlink
