// Fuzzing of the native core with libFuzzer: an input is the index of a translation, and the bytes to translate.
//
// The environment variable ROVERLINK_FUZZ_TABLE names a file that native_core.py has written: each array of the table
// as a count, a size in bytes and the bytes. ROVERLINK_FUZZ_DOOR is to_cdr, to_proto, or receive: then the bytes are a
// datagram for a bridge that passes payload 1 on without a signature, and payload 2 with one, to a topic and to a peer.
#include <sys/socket.h>

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <vector>

#include "roverlink/bridge.h"

namespace {

constexpr size_t kRoom = 1 << 16;  // less than the longest message needs, so that the end of the room is reached, too

std::vector<std::vector<uint64_t>> arrays;  // of words, for the alignment
rl_table table;
rl_workspace *workspace;
bool is_to_cdr, is_receive;
rl_bridge bridge;

template <typename T>
void read(std::FILE *file, const T *&array, uint32_t &count) {
  uint32_t head[2] = {};
  if (std::fread(head, sizeof head, 1, file) != 1) std::abort();
  auto &memory = arrays.emplace_back(head[1] / 8 + 1);
  if (std::fread(memory.data(), 1, head[1], file) != head[1]) std::abort();
  array = reinterpret_cast<const T *>(memory.data());
  count = head[0];
}

int stop() {
  bridge.stopping = 1;
  return 0;
}

// Lets the bridge handle one datagram.
void receive(uint32_t translation, const uint8_t *data, size_t size) {
  static int sockets[4];
  for (int *pair : {sockets, sockets + 2})
    if (*pair == 0 && socketpair(AF_UNIX, SOCK_DGRAM, 0, pair) != 0) std::abort();
  rl_lock lock = {0}, lock_of_clock = {0};
  rl_clock clock = {{0, 0}, &lock_of_clock};
  rl_stream stream = {{1, {}, 0}, UINT64_MAX, &clock};
  rl_stream *const streams[] = {&stream};
  const rl_signer signer = {{2, {}, 0}, &clock, &lock, 23, size % 2 == 0};
  rl_topic topics[2] = {};
  for (rl_topic &topic : topics) {
    topic.translation = translation;
    topic.publisher = &bridge;
  }
  rl_row rows[2] = {};
  for (uint32_t index = 0; index < 2; ++index)
    rows[index] = {index + 1, 1, 0, index, 1, RL_NONE, index, 0, {2, 0, 0, 0}, 1, 0};
  rl_destination destination = {sockets + 3, &signer, 0, 0, 0};
  bridge = {};
  bridge.table = &table;
  bridge.workspace = workspace;
  bridge.topics = topics;
  bridge.rows = rows;
  bridge.destinations = &destination;
  bridge.streams = streams;
  bridge.middleware.count_subscriptions = [](const void *, size_t *count) -> int32_t { return *count = 1, 0; };
  bridge.middleware.publish = [](const void *, const rl_rcl_message *, void *) -> int32_t { return stop(); };
  bridge.calls.handle = [](const rl_datagram *, uint32_t) { return stop(); };
  bridge.calls.send = [](uint32_t, const rl_datagram *, uint32_t) { return 0; };
  bridge.n_topics = bridge.n_rows = 2;
  bridge.n_destinations = bridge.n_streams = 1;
  bridge.signature = 23;
  bridge.is_ordered = 1;
  bridge.socket = sockets[0];
  bridge.wake = -1;
  bridge.largest = 1473;
  send(sockets[1], data, size, 0);
  rl_receive(&bridge);
  uint8_t forwarded[1];
  while (recv(sockets[2], forwarded, sizeof forwarded, MSG_DONTWAIT) >= 0) {
  }
}

}  // namespace

extern "C" int LLVMFuzzerInitialize(int *, char ***) {
  std::FILE *file = std::fopen(std::getenv("ROVERLINK_FUZZ_TABLE"), "rb");
  if (file == nullptr) std::abort();
  read(file, table.fields, table.n_fields);
  read(file, table.layouts, table.n_layouts);
  read(file, table.ops, table.n_ops);
  read(file, table.expressions, table.n_expressions);
  read(file, table.steps, table.n_steps);
  read(file, table.translations, table.n_translations);
  read(file, table.words, table.n_words);
  read(file, table.bytes, table.n_bytes);
  std::fclose(file);
  if (rl_check(&table) != RL_OK) std::abort();
  is_receive = std::strcmp(std::getenv("ROVERLINK_FUZZ_DOOR"), "receive") == 0;
  is_to_cdr = std::strcmp(std::getenv("ROVERLINK_FUZZ_DOOR"), "to_cdr") == 0;
  workspace = rl_workspace_new(1 << 18);
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  if (size == 0) return -1;
  const uint32_t index = data[0] % table.n_translations;
  if (is_receive) {
    receive(index, data + 1, size - 1);
    return 0;
  }
  std::vector<uint8_t> message(kRoom), payload(kRoom);
  size_t message_size = kRoom, payload_size = kRoom;
  if (!is_to_cdr) {
    rl_to_proto(&table, index, workspace, data + 1, size - 1, payload.data(), &payload_size);
    return 0;
  }
  if (rl_to_cdr(&table, index, workspace, data + 1, size - 1, 1, 2, message.data(), &message_size) != RL_OK) return 0;
  // What the core has written, it reads back, and writes to the same message again: if it can be computed from that.
  message.resize(message_size);
  if (rl_to_proto(&table, index, workspace, message.data(), message_size, payload.data(), &payload_size) != RL_OK)
    return 0;
  std::vector<uint8_t> again(kRoom);
  size_t again_size = kRoom;
  rl_to_cdr(&table, index, workspace, payload.data() + kRoom - payload_size, payload_size, 1, 2, again.data(),
            &again_size);
  return 0;
}
