// Check of a table: after it, no index and no slot leads out of the table or of a frame.
#include "frame.hpp"

namespace {

// Checker of one table.
class Checker {
 public:
  explicit Checker(const rl_table &table) : table_(table) {}

  // True if the whole table is right.
  bool all() const {
    for (uint32_t index = 0; index < table_.n_layouts; ++index)
      if (!layout(index)) return false;
    for (uint32_t index = 0; index < table_.n_expressions; ++index)
      if (!expression(table_.expressions[index])) return false;
    for (uint32_t index = 0; index < table_.n_translations; ++index)
      if (!translation(table_.translations[index])) return false;
    return true;
  }

 private:
  // True if `count` elements from `first` on are among `total`.
  static bool within(uint32_t first, uint64_t count, uint32_t total) {
    return first <= total && count <= total - first;
  }

  // A count at `words[index]`, and as many groups of words behind it.
  bool counted(uint32_t index, uint64_t each) const {
    return index < table_.n_words && table_.words[index] <= table_.n_words &&
           within(index + 1, table_.words[index] * each, table_.n_words);
  }

  // A text in `words`.
  bool text(uint32_t index) const {
    return within(index, 2, table_.n_words) && slice(table_.words[index], table_.words[index + 1]);
  }

  // Bytes in `bytes`.
  bool slice(uint64_t start, uint64_t size) const {
    return start <= table_.n_bytes && size <= table_.n_bytes - start;
  }

  // Cases of RL_CHOICE and RL_CASE.
  bool cases(uint32_t index) const {
    if (!counted(index, 3)) return false;
    for (uint64_t number = 0; number < table_.words[index]; ++number)
      if (!text(index + 2 + 3 * static_cast<uint32_t>(number))) return false;
    return true;
  }

  // Layouts refer only to layouts before them, so that no frame contains itself; opaque fields have no frame.
  bool layout(uint32_t index) const {
    const rl_layout &own = table_.layouts[index];
    if (!within(own.first_field, own.fields, table_.n_fields) || own.slots > kMostSlots) return false;
    if (!within(own.defaults, uint64_t{2} * own.slots, table_.n_words)) return false;
    for (uint32_t slot = 0; slot < own.slots; ++slot) {
      const uint64_t *words = table_.words + own.defaults + size_t{2} * slot;
      if (words[1] != 0 && !slice(words[0], words[1])) return false;
    }
    uint32_t last = 0;
    for (uint32_t number = 0; number < own.fields; ++number) {
      const rl_field &field = table_.fields[own.first_field + number];
      if (field.number <= last || field.type == 0 || field.type >= roverlink::PROTO_TYPES) return false;
      last = field.number;
      if (field.extent == 0 || !within(field.slot, field.extent, own.slots)) return false;
      if (field.oneof != RL_NONE && field.oneof >= own.slots) return false;
      if (roverlink::is_message(field.type)) {
        const bool is_opaque = (field.flags & RL_OPAQUE) != 0;
        if (field.layout >= (is_opaque ? table_.n_layouts : index)) return false;
        const bool is_apart = is_opaque || (field.flags & RL_REPEATED) != 0;
        if (field.extent != (is_apart ? 1 : 1 + table_.layouts[field.layout].slots)) return false;
      } else if (field.layout != RL_NONE && !counted(field.layout, 1)) {
        return false;
      }
    }
    return true;
  }

  // An expression, apart from its slots.
  bool expression(const rl_expression &own) const {
    if (!within(own.first_step, own.steps, table_.n_steps)) return false;
    if (own.cases != RL_NONE && !counted(own.cases, 3)) return false;
    if (own.otherwise != RL_NONE && !within(own.otherwise, 2, table_.n_words)) return false;
    for (uint32_t step = 0; step < own.steps; ++step)
      if (table_.steps[own.first_step + step].code >= RL_STEPS) return false;
    return own.source < RL_NUMBERS;
  }

  // A translation with its programs.
  bool translation(const rl_translation &own) const {
    if (own.layout != RL_NONE &&
        (own.layout >= table_.n_layouts || !body(own.to_cdr, own.to_cdr_size, table_.layouts[own.layout].slots, 0)))
      return false;
    if (own.cdr_slots == RL_NONE) return true;
    return own.cdr_slots <= kMostSlots && body(own.from_cdr, own.from_cdr_size, own.cdr_slots, 0) &&
           body(own.to_proto, own.to_proto_size, own.cdr_slots, 0);
  }

  // Operations on a frame of `slots` slots; those of the elements of a list have frames of their own.
  bool body(uint32_t first, uint32_t count, uint32_t slots, uint32_t depth) const {
    if (depth > kDeepest || !within(first, count, table_.n_ops)) return false;
    for (uint32_t index = first; index < first + count; ++index) {
      const rl_op &op = table_.ops[index];
      if (op.size >= first + count - index || !operation(op, slots)) return false;
      if (op.condition != RL_NONE && op.condition >= slots) return false;
      if (op.size != 0 && !body(index + 1, op.size, element_slots(op, slots), depth + 1)) return false;
      index += op.size;
    }
    return true;
  }

  // Size of the frames on which the body of an operation runs.
  static uint32_t element_slots(const rl_op &op, uint32_t slots) {
    switch (op.code) {
      case RL_MESSAGE: return slots;
      case RL_REPEAT: case RL_PACKED: return op.b;
      // The frames of a payload's lists have the size of their layouts, those of a ROS message's lists `number`.
      default: return op.number;
    }
  }

  // An operation, apart from its body.
  bool operation(const rl_op &op, uint32_t slots) const {
    const auto has = [&](uint32_t slot, uint32_t count) { return within(slot, count, slots); };
    const auto computes = [&](uint32_t first, uint32_t count) {
      if (!within(first, count, table_.n_expressions)) return false;
      for (uint32_t index = first; index < first + count; ++index) {
        const rl_expression &own = table_.expressions[index];
        if (own.slot != RL_NONE && !has(own.slot, own.source == RL_NANOSECONDS ? 2 : 1)) return false;
        if (own.presence != RL_NONE && !has(own.presence, 1)) return false;
      }
      return true;
    };
    const bool is_primitive = op.type < RL_PRIMITIVES;
    const bool is_proto = op.type > 0 && op.type < roverlink::PROTO_TYPES;
    switch (op.code) {
      case RL_COPY: case RL_NARROW: return is_primitive && has(op.slot, 1);
      case RL_COMPUTE: return is_primitive && computes(op.a, 1);
      case RL_OCTETS: case RL_PRESENCE: return has(op.slot, 1);
      case RL_TEXT: return has(op.slot, 1) && (op.b == RL_NONE || text(op.b));
      case RL_CHOICE: return has(op.slot, 1) && cases(op.a) && (op.b == RL_NONE || text(op.b));
      case RL_LIST: return has(op.slot, 1) && op.number <= kMostSlots;
      case RL_MAP: return has(op.slot, 1) && op.b < op.number && op.number <= kMostSlots;
      case RL_BYTES: return is_primitive && within(op.a, op.b, table_.n_bytes);
      case RL_WHICH: return is_primitive && has(op.slot, 1) && counted(op.a, 2);
      case RL_STAMP: return true;
      case RL_TIME: case RL_DURATION: return has(op.slot, 2);
      case RL_QUATERNION: return computes(op.a, 3);
      case RL_MOMENT: return computes(op.a, 1);
      case RL_FIELD:
        return is_proto && has(op.slot, 1) && (op.a == RL_NONE || computes(op.a, 1)) &&
               (op.b == RL_NONE || counted(op.b, 1));
      case RL_CASE: return is_proto && has(op.slot, 1) && cases(op.a);
      case RL_MESSAGE: return roverlink::is_message(op.type);
      case RL_REPEAT: case RL_PACKED:
        return has(op.slot, 1) && op.b <= kMostSlots && ((op.flags & RL_UNIQUE) == 0 || op.a < op.b);
      case RL_ANGLES: return has(op.slot, 3) && has(op.a, 4);
      default: return false;
    }
  }

  static constexpr uint32_t kMostSlots = 1 << 16, kDeepest = 64;

  const rl_table &table_;
};

}  // namespace

extern "C" int rl_check(const rl_table *table) { return Checker(*table).all() ? RL_OK : RL_WRONG_TABLE; }
