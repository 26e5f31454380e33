// Protobuf's wire format to a frame, as "Encoding" on protobuf.dev defines it.
//
// All declared fields are read, also those that no program uses, because a payload with a malformed field is refused as
// a whole. Groups and what protobuf reads in another way than other fields are handed over.
#include "frame.hpp"

namespace roverlink {

namespace {

class Reader {
 public:
  Reader(const rl_table &table, rl_workspace &workspace) : table_(table), workspace_(workspace) {}

  bool message(uint32_t index, const uint8_t *at, const uint8_t *end, Slot *frame) {
    const rl_layout &layout = table_.layouts[index];
    const rl_field *fields = table_.fields + layout.first_field;
    while (at < end) {
      uint64_t tag = 0;
      if (!varint(&at, end, &tag) || tag > UINT32_MAX || tag >> 3 == 0) return false;
      const rl_field *field = find(fields, layout.fields, static_cast<uint32_t>(tag >> 3));
      const auto wire = static_cast<Wire>(tag & 7);
      if (field == nullptr) {
        if (!skip(&at, end, wire)) return false;
      } else if (!read(*field, wire, &at, end, frame, fields, layout.fields)) {
        return false;
      }
    }
    for (uint32_t number = 0; number < layout.fields; ++number)
      if ((fields[number].flags & RL_REQUIRED) != 0 && !frame[fields[number].slot].set) return false;
    return true;
  }

  void fill(uint32_t index, Slot *frame) const {
    const rl_layout &layout = table_.layouts[index];
    const uint64_t *word = table_.words + layout.defaults;
    for (uint32_t slot = 0; slot < layout.slots; ++slot, word += 2) {
      frame[slot] = Slot{};
      frame[slot].bits = word[0];
    }
  }

 private:
  static const rl_field *find(const rl_field *fields, uint32_t count, uint32_t number) {
    if (number - 1 < count && fields[number - 1].number == number) return &fields[number - 1];  // no gaps before it
    uint32_t low = 0;
    for (uint32_t high = count; low < high;) {
      const uint32_t middle = low + (high - low) / 2;
      if (fields[middle].number < number) low = middle + 1;
      else high = middle;
    }
    return low < count && fields[low].number == number ? &fields[low] : nullptr;
  }

  static bool varint(const uint8_t **at, const uint8_t *end, uint64_t *value) {
    *value = 0;
    for (uint32_t shift = 0; shift < 70; shift += 7) {
      if (*at == end) return false;
      const uint8_t byte = *(*at)++;
      *value |= static_cast<uint64_t>(byte & 0x7f) << shift;
      if ((byte & 0x80) == 0) return shift < 63 || byte <= 1;
    }
    return false;
  }

  static bool skip(const uint8_t **at, const uint8_t *end, Wire wire) {
    uint64_t size = 0;
    switch (wire) {
      case VARINT: return varint(at, end, &size);
      case FIXED64: size = 8; break;
      case FIXED32: size = 4; break;
      case DELIMITED:
        if (!varint(at, end, &size)) return false;
        break;
      default: return false;  // a group
    }
    if (size > static_cast<uint64_t>(end - *at)) return false;
    *at += size;
    return true;
  }

  bool read(const rl_field &field, Wire wire, const uint8_t **at, const uint8_t *end, Slot *frame,
            const rl_field *fields, uint32_t count) {
    const Wire own = wire_of(field.type);
    const bool repeated = (field.flags & RL_REPEATED) != 0;
    if (wire != own) {
      // A repeated scalar may be packed or not, whatever the schema says. Anything else is an unknown field.
      if (wire != DELIMITED || !repeated || own == DELIMITED) return skip(at, end, wire);
      return packed(field, own, at, end, &frame[field.slot]);
    }
    if (repeated) {
      Slot element{};
      return (field.type == PROTO_MESSAGE ? nested(field, at, end, &element) : scalar(field, own, at, end, &element)) &&
             append(&frame[field.slot], element);
    }
    if (field.oneof != RL_NONE) choose(field, fields, count, frame);
    Slot *slot = &frame[field.slot];
    if (field.type == PROTO_MESSAGE) {
      const uint8_t *start = nullptr;
      if (!content(at, end, &start)) return false;
      slot->set = 1;
      return message(field.layout, start, *at, slot + 1);  // into the same frame: occurrences are merged
    }
    return scalar(field, own, at, end, slot);
  }

  // Sets the member of a oneof, and clears the one that was set before.
  void choose(const rl_field &field, const rl_field *fields, uint32_t count, Slot *frame) const {
    Slot &which = frame[field.oneof];
    if (which.bits == field.number) return;
    if (const rl_field *other = find(fields, count, static_cast<uint32_t>(which.bits))) {
      frame[other->slot] = Slot{};
      if (other->type == PROTO_MESSAGE) fill(other->layout, &frame[other->slot] + 1);
    }
    which.bits = field.number;
    which.set = 1;
  }

  static bool content(const uint8_t **at, const uint8_t *end, const uint8_t **start) {
    uint64_t size = 0;
    if (!varint(at, end, &size) || size > static_cast<uint64_t>(end - *at)) return false;
    *start = *at;
    *at += size;
    return true;
  }

  bool nested(const rl_field &field, const uint8_t **at, const uint8_t *end, Slot *element) {
    const uint8_t *start = nullptr;
    if (!content(at, end, &start)) return false;
    element->frames = workspace_.take<Slot>(table_.layouts[field.layout].slots);
    if (element->frames == nullptr) return false;
    fill(field.layout, element->frames);
    return message(field.layout, start, *at, element->frames);
  }

  bool packed(const rl_field &field, Wire own, const uint8_t **at, const uint8_t *end, Slot *slot) {
    const uint8_t *start = nullptr;
    if (!content(at, end, &start)) return false;
    const uint8_t *stop = *at;
    slot->set = 1;
    while (start < stop) {
      Slot element{};
      if (!scalar(field, own, &start, stop, &element) || !append(slot, element)) return false;
    }
    return true;
  }

  bool scalar(const rl_field &field, Wire own, const uint8_t **at, const uint8_t *end, Slot *slot) const {
    slot->set = 1;
    if (own == VARINT) {
      uint64_t value = 0;
      if (!varint(at, end, &value)) return false;
      switch (field.type) {
        case PROTO_INT32: slot->bits = sign_extended(value); break;
        case PROTO_UINT32: slot->bits = static_cast<uint32_t>(value); break;
        case PROTO_SINT32: {
          const auto low = static_cast<uint32_t>(value);
          slot->bits = sign_extended((low >> 1) ^ (0u - (low & 1u)));
          break;
        }
        case PROTO_SINT64: slot->bits = (value >> 1) ^ (uint64_t{0} - (value & 1)); break;
        case PROTO_BOOL: slot->bits = value != 0; break;
        case PROTO_ENUM:
          slot->bits = sign_extended(value);
          return field.layout == RL_NONE || listed(table_.words + field.layout, slot->bits);
        default: slot->bits = value;
      }
      return true;
    }
    if (own == DELIMITED) {
      const uint8_t *start = nullptr;
      if (!content(at, end, &start)) return false;
      slot->bytes = start;
      slot->size = static_cast<uint32_t>(*at - start);
      return (field.flags & RL_UTF8) == 0 || is_utf8(start, slot->size);
    }
    const size_t size = own == FIXED64 ? 8 : 4;
    if (size > static_cast<size_t>(end - *at)) return false;
    slot->bits = 0;
    std::memcpy(&slot->bits, *at, size);
    if (field.type == PROTO_SFIXED32) slot->bits = sign_extended(slot->bits);
    *at += size;
    return true;
  }

  // A closed enum has no other values: protobuf takes them for unknown fields.
  static bool listed(const uint64_t *values, uint64_t value) {
    for (uint64_t index = 1; index <= values[0]; ++index)
      if (values[index] == value) return true;
    return false;
  }

  bool append(Slot *slot, const Slot &element) {
    Chunk *last = slot->list.last;
    if (last == nullptr || last->count == last->capacity) {
      const uint32_t capacity = last == nullptr ? 4 : last->capacity < 4096 ? 2 * last->capacity : last->capacity;
      auto *chunk = workspace_.take<Chunk>(1, (capacity - 1) * sizeof(Slot));
      if (chunk == nullptr) return false;
      chunk->next = nullptr;
      chunk->count = 0;
      chunk->capacity = capacity;
      if (last == nullptr) slot->list.first = chunk;
      else last->next = chunk;
      slot->list.last = last = chunk;
    }
    last->elements[last->count++] = element;
    ++slot->size;
    slot->set = 1;
    return true;
  }

  const rl_table &table_;
  rl_workspace &workspace_;
};

}  // namespace

bool read_proto(const rl_table &table, uint32_t layout, rl_workspace &workspace, const uint8_t *data, size_t size,
                Slot *frame) {
  Reader reader(table, workspace);
  reader.fill(layout, frame);
  return size <= UINT32_MAX && reader.message(layout, data, data + size, frame);
}

}  // namespace roverlink
