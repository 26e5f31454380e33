// A frame of a ROS 2 message to protobuf's wire format. The bytes are written from the end, so that the length of a
// nested message is known when it is written.
#include "frame.hpp"

namespace roverlink {

namespace {

// Writer of one payload: runs operations that read a frame.
class Writer {
 public:
  Writer(const rl_table &table, uint8_t *out, size_t room) : table_(table), start_(out), at_(out + room) {}

  // The first byte that was written.
  const uint8_t *begin() const { return at_; }

  // Runs a body on a frame.
  bool run(uint32_t first, uint32_t count, const Slot *frame) {
    for (uint32_t index = first; index < first + count; ++index) {
      const rl_op &op = table_.ops[index];
      if ((op.condition == RL_NONE || frame[op.condition].bits == op.expected) && !one(op, index, frame)) return false;
      index += op.size;
    }
    return true;
  }

 private:
  // Runs an operation.
  bool one(const rl_op &op, uint32_t index, const Slot *frame) {
    const Slot &slot = frame[op.slot];
    switch (op.code) {
      case RL_FIELD: return field(op, frame);
      case RL_CASE: return chosen(op, slot);
      case RL_MESSAGE: {
        if (op.type == PROTO_GROUP)
          return tag(op.number, END_GROUP) && run(index + 1, op.size, frame) && tag(op.number, START_GROUP);
        const uint8_t *end = at_;
        return run(index + 1, op.size, frame) && head(op.number, end);
      }
      case RL_REPEAT:
        if ((op.flags & RL_UNIQUE) != 0 && !unique(op, slot)) return false;
        for (uint32_t element = slot.size; element > 0; --element)
          if (!run(index + 1, op.size, slot.frames + static_cast<size_t>(element - 1) * op.b)) return false;
        return true;
      case RL_PACKED: {
        if (slot.size == 0) return true;
        const uint8_t *end = at_;
        for (uint32_t element = slot.size; element > 0; --element)
          if (!run(index + 1, op.size, slot.frames + static_cast<size_t>(element - 1) * op.b)) return false;
        return head(op.number, end);
      }
      case RL_TIME: return time(op, frame, false);
      case RL_DURATION: return time(op, frame, true);
      default: return false;
    }
  }

  // Field `number` from a slot or from expression `a`; number 0 is an element of a packed list, which has no tag.
  bool field(const rl_op &op, const Slot *frame) {
    const Slot &slot = frame[op.slot];
    const Wire wire = wire_of(op.type);
    if (wire == DELIMITED) {
      if ((op.flags & RL_IMPLICIT) != 0 && slot.size == 0) return true;
      return bytes(slot.bytes, slot.size) && varint(slot.size) && tag(op.number, wire);
    }
    uint64_t bits = slot.bits;
    if (op.a != RL_NONE) {
      Number number{};
      if (!compute(table_, table_.expressions[op.a], frame, &number) || !fit(number, primitive_of(op.type), &bits))
        return false;
    }
    return (op.b == RL_NONE || is_listed(table_.words + op.b, bits)) && scalar(op, wire, bits);
  }

  // Field `number` with the number whose text is in a slot.
  bool chosen(const rl_op &op, const Slot &slot) {
    const uint64_t *words = table_.words + op.a;
    for (uint64_t number = 0; number < words[0]; ++number) {
      const uint64_t *one = words + 1 + 3 * number;
      if (one[2] == slot.size && (slot.size == 0 || std::memcmp(table_.bytes + one[1], slot.bytes, slot.size) == 0))
        return scalar(op, wire_of(op.type), one[0]);
    }
    return false;
  }

  // A number with its tag.
  bool scalar(const rl_op &op, Wire wire, uint64_t bits) {
    if ((op.flags & RL_IMPLICIT) != 0 && bits == 0) return true;
    if (op.type == PROTO_SINT32) {
      const auto low = static_cast<uint32_t>(bits);
      bits = (low << 1) ^ (0U - (low >> 31));
    } else if (op.type == PROTO_SINT64) {
      bits = (bits << 1) ^ (uint64_t{0} - (bits >> 63));
    }
    const auto *data = reinterpret_cast<const uint8_t *>(&bits);
    const bool done = wire == VARINT ? varint(bits) : wire == FIXED64 ? bytes(data, 8) : bytes(data, 4);
    return done && (op.number == 0 || tag(op.number, wire));
  }

  // Two entries with the same key would be one in a proto map.
  static bool unique(const rl_op &op, const Slot &slot) {
    if (slot.size > kMostEntries) return false;
    for (uint32_t one = 1; one < slot.size; ++one)
      for (uint32_t other = 0; other < one; ++other) {
        const Slot &a = slot.frames[static_cast<size_t>(one) * op.b + op.a];
        const Slot &b = slot.frames[static_cast<size_t>(other) * op.b + op.a];
        const bool is_text = (op.flags & RL_TEXT_KEY) != 0;
        if (!is_text && a.bits == b.bits) return false;
        if (is_text && a.size == b.size && (a.size == 0 || std::memcmp(a.bytes, b.bytes, a.size) == 0)) return false;
      }
    return true;
  }

  // The ROS 2 primitive that holds the numbers of a proto type.
  static uint8_t primitive_of(uint8_t type) {
    switch (type) {
      case PROTO_DOUBLE: return RL_FLOAT64;
      case PROTO_FLOAT: return RL_FLOAT32;
      case PROTO_INT64: case PROTO_SINT64: case PROTO_SFIXED64: return RL_INT64;
      case PROTO_UINT64: case PROTO_FIXED64: return RL_UINT64;
      case PROTO_UINT32: case PROTO_FIXED32: return RL_UINT32;
      case PROTO_BOOL: return RL_BOOL;
      default: return RL_INT32;
    }
  }

  // Message with seconds (1) and nanos (2), from slots with seconds and nanoseconds.
  bool time(const rl_op &op, const Slot *frame, bool is_duration) {
    auto sec = static_cast<int64_t>(frame[op.slot].bits);
    auto nanosec = static_cast<int64_t>(frame[op.slot + 1].bits);
    if (nanosec >= 1000000000) return false;
    if (is_duration && sec < 0 && nanosec > 0) {
      sec += 1;
      nanosec -= 1000000000;
    }
    const uint8_t *end = at_;
    if (nanosec != 0 && !(varint(static_cast<uint64_t>(nanosec)) && tag(2, VARINT))) return false;
    if (sec != 0 && !(varint(static_cast<uint64_t>(sec)) && tag(1, VARINT))) return false;
    return head(op.number, end);
  }

  // Writes the tag and the length of what ends at `end`.
  bool head(uint32_t number, const uint8_t *end) {
    return varint(static_cast<uint64_t>(end - at_)) && tag(number, DELIMITED);
  }

  // Writes a tag.
  bool tag(uint32_t number, Wire wire) { return varint(static_cast<uint64_t>(number) << 3 | wire); }

  // Writes bytes before those that were written.
  bool bytes(const uint8_t *data, size_t size) {
    if (size > static_cast<size_t>(at_ - start_)) return false;
    at_ -= size;
    if (size != 0) std::memcpy(at_, data, size);
    return true;
  }

  // Writes a varint.
  bool varint(uint64_t value) {
    uint8_t encoded[10];
    size_t size = 0;
    do {
      encoded[size++] = static_cast<uint8_t>((value & 0x7f) | (value > 0x7f ? 0x80 : 0));
      value >>= 7;
    } while (value != 0);
    return bytes(encoded, size);
  }

  static constexpr uint32_t kMostEntries = 1000;

  const rl_table &table_;
  const uint8_t *start_;
  uint8_t *at_;
};

}  // namespace

bool write_proto(const rl_table &table, const rl_translation &translation, const Slot *frame, uint8_t *out,
                 size_t *size) {
  Writer writer(table, out, *size);
  if (!writer.run(translation.to_proto, translation.to_proto_size, frame)) return false;
  *size = static_cast<size_t>(out + *size - writer.begin());
  return true;
}

}  // namespace roverlink
