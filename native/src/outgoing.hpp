// Datagrams of messages that were taken from topics.
#pragma once

#include <algorithm>

#include "frame.hpp"
#include "roverlink/bridge.h"
#include "sending.hpp"
#include "signing.hpp"

namespace roverlink {

constexpr size_t HEADER = 10;             // bytes of the envelope before the payload, at most
constexpr uint32_t EVERYTHING = 0x7f;     // DDS_ANY_STATE

inline uint8_t *write_varint_before(uint8_t *end, uint64_t value) {
  uint8_t digits[10];
  size_t count = 0;
  do {
    digits[count] = static_cast<uint8_t>((value & 0x7f) | (value > 0x7f ? 0x80 : 0));
    value >>= 7;
    ++count;
  } while (value != 0);
  return std::copy(digits, digits + count, end - count) - count;
}

// Writes the envelope of a message at the end of a room. Returns its begin, or null if the core cannot convert it.
inline uint8_t *write_envelope(const rl_server &server, const rl_subscription &topic, rl_workspace *workspace,
                               const rl_rcl_message &message, uint8_t *room, uint8_t *end) {
  auto written = static_cast<size_t>(end - room) - HEADER;
  if (rl_to_proto(server.table, topic.translation, workspace, message.buffer, message.length, room + HEADER, &written) !=
      RL_OK)
    return nullptr;
  uint8_t *const payload = write_varint_before(end - written, written);
  return write_varint_before(payload, uint64_t{topic.number} << 3 | DELIMITED);
}

// Copies a sample of Cyclone DDS. Returns false if memory is short.
inline bool read_sample(const rl_reading &reading, const void *sample, rl_rcl_message &message) {
  const size_t size = reading.size(sample);
  if (size > message.capacity) {
    void *const longer = std::realloc(message.buffer, size);
    if (longer == nullptr) return false;
    message.buffer = static_cast<uint8_t *>(longer);
    message.capacity = size;
  }
  reading.bytes(sample, 0, size, message.buffer);
  message.length = size;
  return true;
}

}  // namespace roverlink
