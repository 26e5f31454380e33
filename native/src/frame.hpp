// Frames: the values of a message between reading and writing, in memory of a fixed size.
#pragma once

#include <cfloat>
#include <cstdint>
#include <cstring>
#ifdef RL_GUARD_WORKSPACE  // for the fuzzer, which has AddressSanitizer
#include <sanitizer/asan_interface.h>
#endif

#include "roverlink/native.h"

namespace roverlink {

// On other machines nothing is compiled, and Python translates.
static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "numbers are copied as they are");
static_assert(FLT_EVAL_METHOD == 0, "each operation rounds to a double, as in Python");

struct Chunk;

// List of a repeated field: chunks in the order of the elements.
struct List {
  Chunk *first, *last;
};

// Value of a field. Integers are sign-extended to 64 bits, a float is its 32 bits, a double its 64 bits, a bool 0 or 1.
struct Slot {
  union {
    uint64_t bits;
    const uint8_t *bytes;  // text, octets, or the elements of a primitive sequence in CDR
    List list;             // lists of protobuf
    Slot *frames;          // frame of a message in a list, or the frames of the elements of a list of CDR
  };
  uint32_t size;  // bytes of a text, elements of a list
  uint32_t set;   // 1 if the field was read
};

// Part of a list. An element is a frame of one slot; the slot of a message refers to the message's own frame.
struct Chunk {
  Chunk *next;
  uint32_t count, capacity;
  Slot elements[1];
};

}  // namespace roverlink

// Memory that one translation uses and the next one uses again.
struct rl_workspace {
  uint8_t *memory;
  size_t room;
  size_t used;

  // Memory for some elements and more bytes. It is null if nothing is left: a message that needs more is handed over.
  template <typename T>
  T *take(size_t count, size_t more = 0) {
    if (count > room / sizeof(T)) return nullptr;
    const size_t wanted = count * sizeof(T) + more, size = (wanted + kGuard + 15) & ~size_t{15};
    if (size > room - used) return nullptr;
    void *place = memory + used;
    used += size;
#ifdef RL_GUARD_WORKSPACE
    __asan_unpoison_memory_region(place, wanted);
#endif
    return static_cast<T *>(place);
  }

  // Makes all memory free from a place on.
  void reset(size_t to) {
    used = to;
#ifdef RL_GUARD_WORKSPACE
    __asan_poison_memory_region(memory + used, room - used);
#endif
  }

#ifdef RL_GUARD_WORKSPACE
  static constexpr size_t kGuard = 16;  // bytes between two places, which nobody may touch
#else
  static constexpr size_t kGuard = 0;
#endif
};

namespace roverlink {

enum : uint8_t {  // google.protobuf.FieldDescriptorProto.Type
  PROTO_DOUBLE = 1, PROTO_FLOAT, PROTO_INT64, PROTO_UINT64, PROTO_INT32, PROTO_FIXED64, PROTO_FIXED32, PROTO_BOOL,
  PROTO_STRING, PROTO_GROUP, PROTO_MESSAGE, PROTO_BYTES, PROTO_UINT32, PROTO_ENUM, PROTO_SFIXED32, PROTO_SFIXED64,
  PROTO_SINT32, PROTO_SINT64, PROTO_TYPES
};

enum Wire : uint32_t { VARINT = 0, FIXED64 = 1, DELIMITED = 2, START_GROUP = 3, END_GROUP = 4, FIXED32 = 5 };

// The wire type of a proto type.
inline Wire wire_of(uint8_t type) {
  switch (type) {
    case PROTO_DOUBLE: case PROTO_FIXED64: case PROTO_SFIXED64: return FIXED64;
    case PROTO_FLOAT: case PROTO_FIXED32: case PROTO_SFIXED32: return FIXED32;
    case PROTO_STRING: case PROTO_BYTES: case PROTO_MESSAGE: return DELIMITED;
    case PROTO_GROUP: return START_GROUP;
    default: return VARINT;
  }
}

// The size of a primitive in bytes.
inline uint32_t size_of(uint8_t primitive) {
  static constexpr uint8_t sizes[RL_PRIMITIVES] = {1, 1, 1, 2, 2, 4, 4, 8, 8, 4, 8};
  return sizes[primitive];
}

// Copies a primitive of 1, 2, 4 or 8 bytes. A `memcpy` of a size that the compiler does not know is a call.
inline void copy_primitive(void *to, const void *from, size_t size) {
  switch (size) {
    case 8: std::memcpy(to, from, 8); break;
    case 4: std::memcpy(to, from, 4); break;
    case 2: std::memcpy(to, from, 2); break;
    default: std::memcpy(to, from, 1);
  }
}

// The padding of CDR before a value at a place. An alignment is a power of two, so that nothing has to be divided.
inline size_t padding_before(size_t place, size_t alignment) { return (size_t{0} - place) & (alignment - 1); }

// A value with the same bits.
template <typename T, typename S>
inline T bits_of(const S &value) {
  static_assert(sizeof(T) == sizeof(S), "the same bits");
  T result;
  std::memcpy(&result, &value, sizeof result);
  return result;
}

// The low 32 bits as a signed integer.
inline uint64_t sign_extended(uint64_t bits) {
  return static_cast<uint64_t>(static_cast<int64_t>(static_cast<int32_t>(static_cast<uint32_t>(bits))));
}

// The bits of a float, of which a signalling NaN becomes a quiet one: Python reads floats as doubles, and so does that.
inline uint64_t quiet(uint64_t bits) {
  constexpr uint64_t exponent = 0x7f800000, mantissa = 0x007fffff, is_quiet = 0x00400000;
  return (bits & exponent) == exponent && (bits & mantissa) != 0 ? bits | is_quiet : bits;
}

// True for the proto types that are messages.
inline bool is_message(uint8_t type) { return type == PROTO_MESSAGE || type == PROTO_GROUP; }

// True for well-formed UTF-8.
bool is_utf8(const uint8_t *text, size_t size);

// Values of a closed enum: a count, and the values.
inline bool is_listed(const uint64_t *values, uint64_t value) {
  for (uint64_t index = 1; index <= values[0]; ++index)
    if (values[index] == value) return true;
  return false;
}

// The steps of a translation. Each returns false if the message has to be handed over.
bool read_proto(const rl_table &, uint32_t layout, rl_workspace &, const uint8_t *data, size_t size, Slot *frame);
bool read_cdr(const rl_table &, const rl_translation &, rl_workspace &, const uint8_t *data, size_t size, Slot *frame);
bool write_cdr(const rl_table &, const rl_translation &, rl_workspace &, const Slot *frame, int32_t sec,
               uint32_t nanosec, uint8_t *out, size_t *size);
bool write_proto(const rl_table &, const rl_translation &, const Slot *frame, uint8_t *out, size_t *size);

// Number as Python has it: an integer, or a double.
struct Number {
  bool whole;
  double real;
  __extension__ __int128 integer;
};

// The value of an expression on a frame; false if there is none.
bool compute(const rl_table &, const rl_expression &, const Slot *frame, Number *result);
// The bits of a number as a primitive of ROS 2; false if it does not fit.
bool fit(const Number &, uint8_t primitive, uint64_t *bits);
// Rotations: roll, pitch and yaw in radians, as roverlink.runtime.convert.rotations has them.
void quaternion(const double angles[3], double xyzw[4]);
void angles(const double xyzw[4], double result[3]);

}  // namespace roverlink
