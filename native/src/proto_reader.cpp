// Protobuf's wire format to a frame, as "Encoding" on protobuf.dev defines it.
//
// All declared fields are read, also those that no program uses, because a payload with a malformed field is refused as
// a whole. A field that proto2 requires may be missing, as for protobuf in Python.
#include "frame.hpp"

namespace roverlink {

namespace {

// Reader of one payload.
class Reader {
 public:
  Reader(const rl_table &table, rl_workspace &workspace) : table_(table), workspace_(workspace) {}

  // Reads a message into its frame, whose slots have been set: those that it does not contain stay as they are. It ends
  // at `end`, or with the end of the group of a number.
  bool message(uint32_t index, const uint8_t **at, const uint8_t *end, Slot *frame, uint32_t group = 0) {
    const rl_layout &layout = table_.layouts[index];
    const rl_field *fields = table_.fields + layout.first_field;
    uint32_t ended = 0;
    while (ended == 0 && *at < end) {
      uint32_t tag = 0;
      if (!varint32(at, end, &tag) || tag >> 3 == 0) return false;
      const rl_field *field = find(fields, layout.fields, tag >> 3);
      const auto wire = static_cast<Wire>(tag & 7);
      if (wire == END_GROUP) {
        ended = tag >> 3;
      } else if (field == nullptr) {
        if (!unknown(layout, at, end, tag)) return false;
      } else if (!read(*field, tag, at, end, frame, layout)) {
        return false;
      }
    }
    return ended == group;
  }

  // Sets slots of a message's frame to the defaults.
  void fill(const rl_layout &layout, uint32_t first, uint32_t count, Slot *frame) const {
    const uint64_t *word = table_.words + layout.defaults + size_t{2} * first;
    for (uint32_t slot = first; slot < first + count; ++slot, word += 2) {
      frame[slot] = Slot{};
      frame[slot].size = static_cast<uint32_t>(word[1]);
      if (word[1] != 0) frame[slot].bytes = table_.bytes + word[0];
      else frame[slot].bits = word[0];
    }
  }

 private:
  // The field of a number, or null.
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

  // Tag or length. protobuf takes no more than five bytes for one, even if the rest are zeros.
  static bool varint32(const uint8_t **at, const uint8_t *end, uint32_t *value) {
    if (*at != end && **at < 0x80) {  // one byte, as most of them
      *value = *(*at)++;
      return true;
    }
    uint64_t wide = 0;
    const uint8_t *start = *at;
    if (!varint(at, end, &wide) || *at - start > 5 || wide > UINT32_MAX) return false;
    *value = static_cast<uint32_t>(wide);
    return true;
  }

  // Reads a varint.
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

  // Reads 32 or 64 bits.
  static bool fixed(const uint8_t **at, const uint8_t *end, size_t size, uint64_t *bits) {
    if (size > static_cast<size_t>(end - *at)) return false;
    *bits = 0;
    copy_primitive(bits, *at, size);
    *at += size;
    return true;
  }

  // Skips an unknown field. Protobuf in Python drops an entry of a map that contains one, so that is handed over.
  bool unknown(const rl_layout &layout, const uint8_t **at, const uint8_t *end, uint32_t tag) {
    return layout.is_entry == 0 && skip(at, end, tag);
  }

  // Skips a field.
  bool skip(const uint8_t **at, const uint8_t *end, uint32_t tag) {
    const uint8_t *start = nullptr;
    uint64_t value = 0;
    switch (tag & 7) {
      case VARINT: return varint(at, end, &value);
      case DELIMITED: return content(at, end, &start);
      case FIXED64: return fixed(at, end, 8, &value);
      case FIXED32: return fixed(at, end, 4, &value);
      case START_GROUP: return skip_group(at, end, tag >> 3);
      default: return false;
    }
  }

  // Skips the fields of an unknown group, and its end.
  bool skip_group(const uint8_t **at, const uint8_t *end, uint32_t number) {
    if (depth_ == kDeepest) return false;
    ++depth_;
    uint32_t tag = 0;
    while (varint32(at, end, &tag) && tag >> 3 != 0 && (tag & 7) != END_GROUP)
      if (!skip(at, end, tag)) return false;
    --depth_;
    return tag == (number << 3 | END_GROUP);
  }

  // Reads a field into its slot.
  bool read(const rl_field &field, uint32_t tag, const uint8_t **at, const uint8_t *end, Slot *frame,
            const rl_layout &layout) {
    const Wire own = wire_of(field.type);
    const bool repeated = (field.flags & RL_REPEATED) != 0;
    Slot *slot = &frame[field.slot];
    if ((tag & 7) != own) {
      // A repeated scalar may be packed or not, whatever the schema says. Anything else is an unknown field.
      const bool is_packed = (tag & 7) == DELIMITED && repeated && own != DELIMITED && own != START_GROUP;
      return is_packed ? packed(field, own, at, end, slot) : unknown(layout, at, end, tag);
    }
    if (field.oneof != RL_NONE) choose(field, layout, frame);
    if ((field.flags & RL_OPAQUE) != 0) {
      slot->set = 1;
      return opaque(field, at, end);
    }
    if (repeated) {
      Slot element{};
      return (is_message(field.type) ? apart(field, at, end, &element) : scalar(field, own, at, end, &element)) &&
             append(slot, element);
    }
    if (!is_message(field.type)) return scalar(field, own, at, end, slot);
    slot->set = 1;
    return nested(field, at, end, slot + 1);  // into the same frame: occurrences are merged
  }

  // Sets the member of a oneof, and clears the one that was set before.
  void choose(const rl_field &field, const rl_layout &layout, Slot *frame) const {
    Slot &which = frame[field.oneof];
    if (which.bits == field.number) return;
    const rl_field *fields = table_.fields + layout.first_field;
    if (const rl_field *other = find(fields, layout.fields, static_cast<uint32_t>(which.bits)))
      fill(layout, other->slot, other->extent, frame);
    which.bits = field.number;
    which.set = 1;
  }

  // Reads a length, and moves `at` behind the bytes that it counts.
  static bool content(const uint8_t **at, const uint8_t *end, const uint8_t **start) {
    uint32_t size = 0;
    if (!varint32(at, end, &size) || size > static_cast<size_t>(end - *at)) return false;
    *start = *at;
    *at += size;
    return true;
  }

  // Reads the message of a field into its frame.
  bool nested(const rl_field &field, const uint8_t **at, const uint8_t *end, Slot *frame) {
    if (field.type == PROTO_GROUP) return message(field.layout, at, end, frame, field.number);
    const uint8_t *start = nullptr;
    return content(at, end, &start) && message(field.layout, &start, *at, frame);
  }

  // Reads a message into a frame of its own.
  bool apart(const rl_field &field, const uint8_t **at, const uint8_t *end, Slot *element) {
    const rl_layout &layout = table_.layouts[field.layout];
    element->frames = workspace_.take<Slot>(layout.slots);
    if (element->frames == nullptr) return false;
    fill(layout, 0, layout.slots, element->frames);
    return nested(field, at, end, element->frames);
  }

  // Reads a message that no program uses, because it must be well-formed too.
  bool opaque(const rl_field &field, const uint8_t **at, const uint8_t *end) {
    if (depth_ == kDeepest) return false;
    const size_t used = workspace_.used;
    Slot element{};
    ++depth_;
    const bool done = apart(field, at, end, &element);
    --depth_;
    workspace_.reset(used);
    return done;
  }

  // Reads a packed list, and appends its elements.
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

  // Reads a number, a text or bytes.
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
          slot->bits = sign_extended((low >> 1) ^ (0U - (low & 1U)));
          break;
        }
        case PROTO_SINT64: slot->bits = (value >> 1) ^ (uint64_t{0} - (value & 1)); break;
        case PROTO_BOOL: slot->bits = value != 0; break;
        case PROTO_ENUM:
          slot->bits = sign_extended(value);
          // A closed enum has no other values: protobuf takes them for unknown fields.
          return field.layout == RL_NONE || is_listed(table_.words + field.layout, slot->bits);
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
    if (!fixed(at, end, own == FIXED64 ? 8 : 4, &slot->bits)) return false;
    if (field.type == PROTO_SFIXED32) slot->bits = sign_extended(slot->bits);
    if (field.type == PROTO_FLOAT) slot->bits = quiet(slot->bits);
    return true;
  }

  // Appends an element to a list.
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

  static constexpr uint32_t kDeepest = 32;  // of opaque messages and unknown groups; protobuf has a limit too

  const rl_table &table_;
  rl_workspace &workspace_;
  uint32_t depth_ = 0;
};

}  // namespace

bool read_proto(const rl_table &table, uint32_t layout, rl_workspace &workspace, const uint8_t *data, size_t size,
                Slot *frame) {
  Reader reader(table, workspace);
  reader.fill(table.layouts[layout], 0, table.layouts[layout].slots, frame);
  return size <= UINT32_MAX && reader.message(layout, &data, data + size, frame);
}

}  // namespace roverlink
