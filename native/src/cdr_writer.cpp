// A frame of a payload to a serialized ROS 2 message: XCDR version 1, little endian (OMG DDS-XTypes 1.3, 7.4.1).
#include <algorithm>

#include "frame.hpp"

namespace roverlink {

namespace {

__extension__ using Wide = __int128;

// Writer of one message: runs operations that read a frame.
class Writer {
 public:
  Writer(const rl_table &table, rl_workspace &workspace, uint8_t *out, size_t room, int32_t sec, uint32_t nanosec)
      : table_(table), workspace_(workspace), body_(out), room_(room), sec_(sec), nanosec_(nanosec) {}

  // Bytes that were written.
  size_t size() const { return used_; }

  // Runs a body on a frame.
  bool run(uint32_t first, uint32_t count, const Slot *frame) {
    for (uint32_t index = first; index < first + count; ++index) {
      const rl_op &op = table_.ops[index];
      if (!one(op, index, frame)) return false;
      index += op.size;
    }
    return true;
  }

 private:
  // Runs an operation.
  bool one(const rl_op &op, uint32_t index, const Slot *frame) {
    const Slot &slot = frame[op.slot];
    switch (op.code) {
      case RL_COPY: return put(slot.bits, size_of(op.type));
      case RL_NARROW: {
        Number number{};
        number.whole = true;
        number.integer = static_cast<int64_t>(slot.bits);
        return put_number(number, op.type);
      }
      case RL_COMPUTE: {
        Number number{};
        return compute(table_, table_.expressions[op.a], frame, &number) && put_number(number, op.type);
      }
      case RL_TEXT: return text(slot.set == 0 && op.b != RL_NONE ? stored(op.b) : slot, op.a);
      case RL_CHOICE: return choice(op, slot.bits);
      case RL_OCTETS: return octets(op, slot);
      case RL_LIST: return list(op, index, slot);
      case RL_MAP: return map(op, index, slot);
      case RL_BYTES: return block(table_.bytes + op.a, op.b, size_of(op.type));
      case RL_PRESENCE: return put(slot.set, 1);
      case RL_WHICH: return put(constant_of(op.a, slot.bits), size_of(op.type));
      case RL_STAMP: return put(static_cast<uint32_t>(sec_), 4) && put(nanosec_, 4);
      case RL_TIME: return time(static_cast<int64_t>(slot.bits), static_cast<int64_t>((&slot)[1].bits));
      case RL_DURATION: return duration(static_cast<int64_t>(slot.bits), static_cast<int64_t>((&slot)[1].bits));
      case RL_QUATERNION: return rotation(op, frame);
      case RL_MOMENT: return moment(op, frame);
      default: return false;
    }
  }

  // Writes the padding before a value.
  bool align(size_t size) {
    const size_t padding = padding_before(used_, size);
    if (padding > room_ - used_) return false;
    for (const size_t end = used_ + padding; used_ < end; ++used_) body_[used_] = 0;
    return true;
  }

  // Writes the low bytes of a value.
  bool put(uint64_t bits, uint32_t size) {
    if (!align(size) || size > room_ - used_) return false;
    copy_primitive(body_ + used_, &bits, size);  // little endian, as the machine
    used_ += size;
    return true;
  }

  // Writes a number, if the primitive can hold it.
  bool put_number(const Number &number, uint8_t primitive) {
    uint64_t bits = 0;
    return fit(number, primitive, &bits) && put(bits, size_of(primitive));
  }

  // Writes bytes. Nothing is aligned for no bytes, as in an empty sequence.
  bool block(const uint8_t *data, size_t size, size_t alignment) {
    if (size == 0) return true;
    if (!align(alignment) || size > room_ - used_) return false;
    std::memcpy(body_ + used_, data, size);
    used_ += size;
    return true;
  }

  // A text of the table.
  Slot stored(uint32_t index) const {
    Slot slot{};
    slot.bytes = table_.bytes + table_.words[index];
    slot.size = static_cast<uint32_t>(table_.words[index + 1]);
    return slot;
  }

  // Writes the text of a number.
  bool choice(const rl_op &op, uint64_t value) {
    const uint64_t *words = table_.words + op.a;
    for (uint32_t number = 0; number < words[0]; ++number)
      if (words[1 + 3 * number] == value) return text(stored(op.a + 2 + 3 * number), RL_NONE);
    return op.b != RL_NONE && text(stored(op.b), RL_NONE);
  }

  // Writes a string.
  bool text(const Slot &slot, uint32_t bound) {
    // ROS 2 readers take the first NUL for the end, so a text that contains one is refused.
    if (slot.size > bound || (slot.size != 0 && std::memchr(slot.bytes, 0, slot.size) != nullptr)) return false;
    return put(slot.size + 1, 4) && block(slot.bytes, slot.size, 1) && put(0, 1);
  }

  // Writes a sequence or an array of octets.
  bool octets(const rl_op &op, const Slot &slot) {
    if ((op.flags & RL_ARRAY) != 0) return slot.size == op.b && block(slot.bytes, slot.size, 1);
    return slot.size <= op.a && put(slot.size, 4) && block(slot.bytes, slot.size, 1);
  }

  // Checks a number of elements, and writes it if the list is a sequence.
  bool count(const rl_op &op, uint32_t size) {
    return (op.flags & RL_ARRAY) != 0 ? size == op.b : size <= op.a && put(size, 4);
  }

  // Writes the elements of a list.
  bool list(const rl_op &op, uint32_t index, const Slot &slot) {
    if (!count(op, slot.size)) return false;
    for (const Chunk *chunk = slot.list.first; chunk != nullptr; chunk = chunk->next)
      for (uint32_t item = 0; item < chunk->count; ++item) {
        const Slot *element = &chunk->elements[item];
        if (!run(index + 1, op.size, (op.flags & RL_FRAMES) != 0 ? element->frames : element)) return false;
      }
    return true;
  }

  // Writes the entries of a map, sorted by their keys.
  bool map(const rl_op &op, uint32_t index, const Slot &slot) {
    const Slot **entries = workspace_.take<const Slot *>(slot.size);
    if (entries == nullptr) return false;
    uint32_t size = 0;
    for (const Chunk *chunk = slot.list.first; chunk != nullptr; chunk = chunk->next)
      for (uint32_t item = 0; item < chunk->count; ++item) entries[size++] = chunk->elements[item].frames;
    const auto before = [&op](const Slot *left, const Slot *right) {
      const Slot &a = left[op.b], &b = right[op.b];
      if ((op.flags & RL_TEXT_KEY) != 0) {  // by code points, which is the order of UTF-8's bytes
        const size_t common = std::min(a.size, b.size);
        const int order = common == 0 ? 0 : std::memcmp(a.bytes, b.bytes, common);
        return order != 0 ? order < 0 : a.size < b.size;
      }
      if ((op.flags & RL_SIGNED_KEY) != 0) return static_cast<int64_t>(a.bits) < static_cast<int64_t>(b.bits);
      return a.bits < b.bits;
    };
    // Insertion keeps the order of equal keys, and needs no memory; maps of messages are small.
    if (size > kMostEntries) return false;
    for (uint32_t from = 1; from < size; ++from) {
      const Slot *entry = entries[from];
      uint32_t to = from;
      for (; to > 0 && before(entry, entries[to - 1]); --to) entries[to] = entries[to - 1];
      entries[to] = entry;
    }
    uint32_t kept = 0;
    for (uint32_t item = 0; item < size; ++item)  // of equal keys the last one counts
      if (item + 1 == size || before(entries[item], entries[item + 1])) entries[kept++] = entries[item];
    if (!count(op, kept)) return false;
    for (uint32_t item = 0; item < kept; ++item)
      if (!run(index + 1, op.size, entries[item])) return false;
    return true;
  }

  // The constant of a oneof's member; 0 for none.
  uint64_t constant_of(uint32_t cases, uint64_t value) const {
    const uint64_t *words = table_.words + cases;
    for (uint64_t index = 0; index < words[0]; ++index)
      if (words[1 + 2 * index] == value) return words[2 + 2 * index];
    return 0;
  }

  // Writes a builtin_interfaces/Time.
  bool time(int64_t sec, int64_t nanosec) {
    if (sec < INT32_MIN || sec > INT32_MAX || nanosec < 0 || nanosec >= kNanoseconds) return false;
    return put(static_cast<uint64_t>(sec), 4) && put(static_cast<uint64_t>(nanosec), 4);
  }

  // Writes a builtin_interfaces/Duration, whose nanoseconds are never negative, as those of protobuf can be.
  bool duration(int64_t sec, int64_t nanosec) {
    if (nanosec <= -kNanoseconds || nanosec >= kNanoseconds) return false;
    if ((sec < 0 && nanosec > 0) || (sec > 0 && nanosec < 0)) return false;
    if (nanosec < 0) {
      if (sec == INT64_MIN) return false;
      sec -= 1;
      nanosec += kNanoseconds;
    }
    return time(sec, nanosec);
  }

  // Writes a quaternion from angles.
  bool rotation(const rl_op &op, const Slot *frame) {
    double angles[3], xyzw[4];
    for (uint32_t axis = 0; axis < 3; ++axis) {
      Number number{};
      if (!compute(table_, table_.expressions[op.a + axis], frame, &number)) return false;
      angles[axis] = number.whole ? static_cast<double>(number.integer) : number.real;
      if (!(angles[axis] - angles[axis] == 0)) return false;  // Python's sin raises for infinity
    }
    quaternion(angles, xyzw);
    return std::all_of(xyzw, xyzw + 4, [this](double part) { return put(bits_of<uint64_t>(part), 8); });
  }

  // Writes a time or a duration from a number of nanoseconds.
  bool moment(const rl_op &op, const Slot *frame) {
    Number number{};
    if (!compute(table_, table_.expressions[op.a], frame, &number) || !number.whole) return false;
    Wide sec = number.integer / kNanoseconds, nanosec = number.integer % kNanoseconds;
    if (nanosec < 0) {
      sec -= 1;
      nanosec += kNanoseconds;
    }
    if (sec < INT32_MIN || sec > INT32_MAX) return false;
    return put(static_cast<uint64_t>(sec), 4) && put(static_cast<uint64_t>(nanosec), 4);
  }

  static constexpr int64_t kNanoseconds = 1000000000;  // in a second
  static constexpr uint32_t kMostEntries = 1000;

  const rl_table &table_;
  rl_workspace &workspace_;
  uint8_t *body_;
  size_t room_, used_ = 0;
  int32_t sec_;
  uint32_t nanosec_;
};

}  // namespace

bool write_cdr(const rl_table &table, const rl_translation &translation, rl_workspace &workspace, const Slot *frame,
               int32_t sec, uint32_t nanosec, uint8_t *out, size_t *size) {
  constexpr uint8_t header[4] = {0, 1, 0, 0};  // PLAIN_CDR, little endian, no options
  if (*size < sizeof header) return false;
  std::memcpy(out, header, sizeof header);
  Writer writer(table, workspace, out + sizeof header, *size - sizeof header, sec, nanosec);
  if (!writer.run(translation.to_cdr, translation.to_cdr_size, frame)) return false;
  *size = sizeof header + writer.size();
  return true;
}

}  // namespace roverlink
