// Fuzzing of the native core with libFuzzer: an input is the index of a translation, and the bytes to translate.
//
// The environment variable ROVERLINK_FUZZ_TABLE names a file that native_core.py has written: each array of the table
// as a count, a size in bytes and the bytes. ROVERLINK_FUZZ_DOOR is to_cdr or to_proto.
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <vector>

#include "roverlink/native.h"

namespace {

constexpr size_t kRoom = 1 << 16;  // less than the longest message needs, so that the end of the room is reached, too

std::vector<std::vector<uint64_t>> arrays;  // of words, for the alignment
rl_table table;
rl_workspace *workspace;
bool is_to_cdr;

template <typename T>
void read(std::FILE *file, const T *&array, uint32_t &count) {
  uint32_t head[2] = {};
  if (std::fread(head, sizeof head, 1, file) != 1) std::abort();
  auto &memory = arrays.emplace_back(head[1] / 8 + 1);
  if (std::fread(memory.data(), 1, head[1], file) != head[1]) std::abort();
  array = reinterpret_cast<const T *>(memory.data());
  count = head[0];
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
  is_to_cdr = std::strcmp(std::getenv("ROVERLINK_FUZZ_DOOR"), "to_cdr") == 0;
  workspace = rl_workspace_new(1 << 18);
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  if (size == 0) return -1;
  const uint32_t index = data[0] % table.n_translations;
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
