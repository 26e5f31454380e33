// A serialized ROS 2 message to a frame.
#include "frame.hpp"

namespace roverlink {

namespace {

// Reader of one message: runs operations that fill a frame.
class Reader {
 public:
  Reader(const rl_table &table, rl_workspace &workspace, const uint8_t *body, size_t size)
      : table_(table), workspace_(workspace), body_(body), size_(size) {}

  // Runs a body on a frame.
  bool run(uint32_t first, uint32_t count, Slot *frame) {
    for (uint32_t index = first; index < first + count; ++index) {
      const rl_op &op = table_.ops[index];
      if (!one(op, index, frame)) return false;
      index += op.size;
    }
    return true;
  }

 private:
  // Runs an operation.
  bool one(const rl_op &op, uint32_t index, Slot *frame) {
    Slot *slot = &frame[op.slot];
    switch (op.code) {
      case RL_COPY: return primitive(op.type, slot);
      case RL_WHICH: return primitive(op.type, slot) && known(op.a, slot->bits);
      case RL_TEXT: return text(slot);
      case RL_OCTETS: return count(op, slot) && take(slot, slot->size);
      case RL_LIST: return list(op, index, slot);
      case RL_ANGLES: {
        double xyzw[4], found[3];
        for (uint32_t axis = 0; axis < 4; ++axis) xyzw[axis] = bits_of<double>(frame[op.a + axis].bits);
        angles(xyzw, found);
        for (uint32_t axis = 0; axis < 3; ++axis) slot[axis].bits = bits_of<uint64_t>(found[axis]);
        return true;
      }
      default: return false;
    }
  }

  // Skips the padding before a value.
  bool align(size_t size) {
    const size_t padding = padding_before(used_, size);
    if (padding > size_ - used_) return false;
    used_ += padding;
    return true;
  }

  // Reads a primitive into a slot.
  bool primitive(uint8_t type, Slot *slot) {
    const uint32_t size = size_of(type);
    if (!align(size) || size > size_ - used_) return false;
    slot->bits = 0;
    copy_primitive(&slot->bits, body_ + used_, size);
    used_ += size;
    switch (type) {
      case RL_BOOL: slot->bits = slot->bits != 0; break;
      case RL_INT8: slot->bits = sign_extended(static_cast<uint64_t>(static_cast<int8_t>(slot->bits))); break;
      case RL_INT16: slot->bits = sign_extended(static_cast<uint64_t>(static_cast<int16_t>(slot->bits))); break;
      case RL_INT32: slot->bits = sign_extended(slot->bits); break;
      case RL_FLOAT32: slot->bits = quiet(slot->bits); break;
      default: break;
    }
    return true;
  }

  // Refers a slot to bytes of the message.
  bool take(Slot *slot, uint32_t size) {
    if (size > size_ - used_) return false;
    slot->bytes = body_ + used_;
    slot->size = size;
    used_ += size;
    return true;
  }

  // Reads a length.
  bool counter(uint32_t *value) {
    Slot slot{};
    if (!primitive(RL_UINT32, &slot)) return false;
    *value = static_cast<uint32_t>(slot.bits);
    return true;
  }

  // Reads a string.
  bool text(Slot *slot) {
    uint32_t size = 0;
    if (!counter(&size) || size == 0 || !take(slot, size)) return false;
    slot->size = size - 1;  // without the NUL
    return is_utf8(slot->bytes, slot->size);
  }

  // Sets the number of elements of a sequence, which is in the message, or of an array.
  bool count(const rl_op &op, Slot *slot) {
    if ((op.flags & RL_ARRAY) == 0) return counter(&slot->size);
    slot->size = op.b;
    return true;
  }

  // Reads the elements of a list into frames, one behind the other.
  bool list(const rl_op &op, uint32_t index, Slot *slot) {
    if (!count(op, slot)) return false;
    const uint32_t elements = slot->size;
    if (elements > size_ - used_) return false;  // an element has at least one byte
    const uint32_t slots = op.number;
    slot->frames = workspace_.take<Slot>(static_cast<size_t>(elements) * slots);
    if (slot->frames == nullptr) return false;
    for (uint32_t element = 0; element < elements; ++element) {
      Slot *frame = slot->frames + static_cast<size_t>(element) * slots;
      for (uint32_t each = 0; each < slots; ++each) frame[each] = Slot{};
      if (!run(index + 1, op.size, frame)) return false;
    }
    return true;
  }

  // True if a number stands for a member of a oneof, or for none.
  bool known(uint32_t cases, uint64_t value) const {
    const uint64_t *words = table_.words + cases;
    for (uint64_t index = 0; index < words[0]; ++index)
      if (words[2 + 2 * index] == value) return true;
    return value == 0;
  }

  const rl_table &table_;
  rl_workspace &workspace_;
  const uint8_t *body_;
  size_t size_, used_ = 0;
};

}  // namespace

bool read_cdr(const rl_table &table, const rl_translation &translation, rl_workspace &workspace, const uint8_t *data,
              size_t size, Slot *frame) {
  if (size < 4 || data[0] != 0 || data[1] != 1) return false;  // not little endian: Python reads both
  for (uint32_t slot = 0; slot < translation.cdr_slots; ++slot) frame[slot] = Slot{};
  Reader reader(table, workspace, data + 4, size - 4);
  return reader.run(translation.from_cdr, translation.from_cdr_size, frame);
}

}  // namespace roverlink
