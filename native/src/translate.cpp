// The C interface.
#include <cstdlib>

#include "frame.hpp"

using roverlink::Slot;

extern "C" {

uint32_t rl_interface(void) { return RL_INTERFACE; }

rl_workspace *rl_workspace_new(size_t bytes) {
  auto *workspace = static_cast<rl_workspace *>(std::malloc(sizeof(rl_workspace)));
  auto *memory = static_cast<uint8_t *>(std::malloc(bytes));
  if (workspace == nullptr || memory == nullptr) {
    std::free(workspace);
    std::free(memory);
    return nullptr;
  }
  *workspace = {memory, bytes, 0};
  return workspace;
}

void rl_workspace_free(rl_workspace *workspace) {
  if (workspace == nullptr) return;
  std::free(workspace->memory);
  std::free(workspace);
}

int rl_to_cdr(const rl_table *table, uint32_t index, rl_workspace *workspace, const uint8_t *payload,
              size_t payload_size, int32_t sec, uint32_t nanosec, uint8_t *out, size_t *size) {
  workspace->reset(0);
  const rl_translation &translation = table->translations[index];
  if (translation.layout == RL_NONE) return RL_HAND_OVER;
  auto *frame = workspace->take<Slot>(table->layouts[translation.layout].slots);
  const bool done =
      frame != nullptr && roverlink::read_proto(*table, translation.layout, *workspace, payload, payload_size, frame) &&
      roverlink::write_cdr(*table, translation, *workspace, frame, sec, nanosec, out, size);
  return done ? RL_OK : RL_HAND_OVER;
}

int rl_to_proto(const rl_table *table, uint32_t index, rl_workspace *workspace, const uint8_t *cdr, size_t cdr_size,
                uint8_t *out, size_t *size) {
  workspace->reset(0);
  const rl_translation &translation = table->translations[index];
  if (translation.cdr_slots == RL_NONE) return RL_HAND_OVER;
  auto *frame = workspace->take<Slot>(translation.cdr_slots);
  const bool done = frame != nullptr &&
                    roverlink::read_cdr(*table, translation, *workspace, cdr, cdr_size, frame) &&
                    roverlink::write_proto(*table, translation, frame, out, size);
  return done ? RL_OK : RL_HAND_OVER;
}

}  // extern "C"
