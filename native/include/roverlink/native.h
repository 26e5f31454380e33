/* Translation between protobuf's wire format and ROS 2's serialized messages (CDR) by a table. Plain C, no Python.
 *
 * A table is data: arrays of the structs below, which refer to each other by index. `rl_check` checks once that no
 * index leads out of the table or out of a frame. That an operation fits the kind of its slot is up to who makes the
 * table, roverlink.runtime.native. A table never changes after that, and any number of threads may use it; each
 * thread needs a workspace of its own.
 *
 * A payload is read into a frame: an array of slots, one for each singular field, each list and each oneof. Programs
 * are arrays of operations, which read slots and write bytes, or read bytes and write slots.
 *
 * What the table or the data ask for and this library does not do has the result `RL_HAND_OVER`: the caller converts
 * the message in Python, which gives the message, or the error with its reason.
 */
#ifndef ROVERLINK_NATIVE_H
#define ROVERLINK_NATIVE_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define RL_API __attribute__((visibility("default"))) /* what the library exports */
#define RL_NONE 0xffffffffu                           /* no index, no bound */
#define RL_INTERFACE 5 /* version of this interface; increase it with each change of this file that callers notice */

enum rl_result { RL_OK = 0, RL_HAND_OVER = 1, RL_WRONG_TABLE = 2 };

/* Primitive types of ROS 2 (CDR), as far as bytes tell them apart: `byte` and `char` are RL_UINT8. */
enum rl_primitive {
  RL_BOOL, RL_INT8, RL_UINT8, RL_INT16, RL_UINT16, RL_INT32, RL_UINT32, RL_INT64, RL_UINT64, RL_FLOAT32, RL_FLOAT64,
  RL_PRIMITIVES
};

/* Field of a proto message. */
enum rl_field_flag {
  RL_REPEATED = 1,
  RL_UTF8 = 2,
  RL_OPAQUE = 4 /* message that contains the message of the field: it is read, and not kept */
};

typedef struct rl_field {
  uint32_t number;
  uint8_t type;    /* google.protobuf.FieldDescriptorProto.Type */
  uint8_t flags;   /* rl_field_flag */
  uint16_t unused;
  uint32_t slot;   /* first slot of the field, counted from the first slot of its message */
  uint32_t extent; /* number of slots: 1, and those of a singular message inside */
  uint32_t oneof;  /* slot of the oneof that contains the field, which holds the number of the member; or RL_NONE */
  uint32_t layout; /* of a message: its layout; of a closed enum: index in `words` of a count and the values */
} rl_field;

/* Proto message: its fields, sorted by number. */
typedef struct rl_layout {
  uint32_t first_field, fields;
  uint32_t slots;
  uint32_t defaults; /* index in `words` of the first slot's default, two words a slot: a number and 0, or a text */
  uint32_t is_entry; /* 1 for an entry of a map */
} rl_layout;

/* Operations. `slot` is a slot of the frame; a body is the `size` operations behind the operation. A text is two words:
 * an index in `bytes`, and a length. */
enum rl_code {
  /* CDR from a frame of a payload, and CDR to a frame of a ROS message. */
  RL_COPY,      /* primitive `type`, the same in both */
  RL_NARROW,    /* integer of `type` from an enum's int32 */
  RL_COMPUTE,   /* primitive `type` from expression `a` */
  RL_TEXT,      /* string; `a` is its bound; `b` is the text in `words` if the slot is not set, or RL_NONE */
  RL_CHOICE,    /* string for the number in the slot: `a` is the index in `words` of a count and as many cases, each
                   a number and a text; `b` is the text for other numbers, or RL_NONE */
  RL_OCTETS,    /* uint8 sequence, `a` is its bound; or array of length `b` */
  RL_LIST,      /* sequence, `a` is its bound; or array of length `b`; the body writes or reads an element, whose
                   frame has `number` slots */
  RL_MAP,       /* sequence of entries; slot `b` of an entry is the key, by which they are sorted; as RL_LIST */
  RL_BYTES,     /* `b` constant bytes at `a` in `bytes`, aligned to `type`; reading skips nothing */
  RL_PRESENCE,  /* bool: the slot is set */
  RL_WHICH,     /* `type` for the oneof's member in the slot: cases at `a` */
  RL_STAMP,     /* time of receipt */
  RL_TIME,      /* builtin_interfaces/Time of slots with seconds and nanoseconds */
  RL_DURATION,
  RL_QUATERNION, /* from the expressions `a`, `a` + 1 and `a` + 2: roll, pitch and yaw in radians */
  RL_MOMENT,     /* time or duration from expression `a`, which gives nanoseconds */
  /* Protobuf from a frame of a ROS message: fields in the order of falling numbers, written from the end. */
  RL_FIELD,    /* field `number` of proto type `type`, from the slot or from expression `a`; `b` is the index in `words`
                  of a count and the values of a closed enum, or RL_NONE */
  RL_CASE,     /* the same, but the number for the text in the slot: cases `a` as those of RL_CHOICE */
  RL_MESSAGE,  /* field `number` of proto type `type`, message or group; the body writes the message */
  RL_REPEAT,   /* each element of a list, whose frames have `b` slots; the body writes one element */
  RL_PACKED,   /* field `number`; as RL_REPEAT, with elements of field 0, which have no tag */
  RL_ANGLES,   /* roll, pitch and yaw in slots `slot` to `slot` + 2 from the quaternion in slots `a` to `a` + 3 */
  RL_CODES
};

enum rl_op_flag {
  RL_ARRAY = 1,
  RL_TEXT_KEY = 2,
  RL_SIGNED_KEY = 4,
  RL_IMPLICIT = 8,  /* the field is left out if it is zero */
  RL_FRAMES = 16,   /* the elements of the list are messages */
  RL_UNIQUE = 32    /* no two elements of the list have the same value in slot `a` */
};

typedef struct rl_op {
  uint8_t code;
  uint8_t type;
  uint16_t flags;
  uint32_t slot;
  uint32_t a, b;
  uint32_t size;       /* operations in the body */
  uint32_t number;     /* of a proto field */
  uint32_t condition;  /* slot that must hold `expected`, else the operation is skipped; or RL_NONE */
  uint32_t expected;
} rl_op;

/* Number computed from a slot: steps in order, then rounding. */
enum rl_number { RL_SIGNED, RL_UNSIGNED, RL_SINGLE, RL_DOUBLE, RL_NANOSECONDS /* of a time in two slots */,
  RL_NUMBERS };
enum rl_expression_flag { RL_ROUND = 1, RL_CHECK_SINGLE = 2 };

typedef struct rl_expression {
  uint8_t source;    /* rl_number */
  uint8_t flags;     /* rl_expression_flag */
  uint16_t steps;
  uint32_t slot;     /* RL_NONE: the constant `otherwise` */
  uint32_t presence; /* slot that has to be set, else the value is `otherwise`; or RL_NONE */
  uint32_t first_step;
  uint32_t cases;    /* index in `words`: count, then pairs of value and counterpart; or RL_NONE */
  uint32_t otherwise; /* index in `words` of the value's kind (1: whole) and its bits; RL_NONE: no such value */
} rl_expression;

enum rl_step_code { RL_NEGATE, RL_TIMES, RL_BY, RL_PLUS, RL_MINUS, RL_FLOORED, RL_STEPS };

typedef struct rl_step {
  uint32_t code;
  uint32_t is_whole; /* 1: the operand is `whole`, and an integer stays one; 0: it is `real` */
  double real;
  int64_t whole;
} rl_step;

/* Conversion of one message in both directions. */
typedef struct rl_translation {
  uint32_t layout;                 /* of the payload; RL_NONE: the message cannot be computed from the payload */
  uint32_t to_cdr, to_cdr_size;    /* operations on a frame of the payload */
  uint32_t from_cdr, from_cdr_size;  /* operations that fill a frame of the ROS message */
  uint32_t cdr_slots;              /* size of that frame; RL_NONE: the payload cannot be computed from the message */
  uint32_t to_proto, to_proto_size;
} rl_translation;

typedef struct rl_table {
  const rl_field *fields;
  const rl_layout *layouts;
  const rl_op *ops;
  const rl_expression *expressions;
  const rl_step *steps;
  const rl_translation *translations;
  const uint64_t *words;
  const uint8_t *bytes;
  uint32_t n_fields, n_layouts, n_ops, n_expressions, n_steps, n_translations, n_words, n_bytes;
} rl_table;

/* Memory of one thread: a fixed size, which no datagram changes. */
typedef struct rl_workspace rl_workspace;

RL_API rl_workspace *rl_workspace_new(size_t bytes);
RL_API void rl_workspace_free(rl_workspace *);

/* RL_INTERFACE of the library, by which a caller recognizes one that was built from other sources. */
RL_API uint32_t rl_interface(void);

/* RL_OK, or RL_WRONG_TABLE if an index leads out of the table. */
RL_API int rl_check(const rl_table *);

/* Write the serialized ROS 2 message of a payload, with its encapsulation header. `size` holds the room of `out`, then
 * the number of bytes written. `sec` and `nanosec` are the time of receipt. */
RL_API int rl_to_cdr(const rl_table *, uint32_t translation, rl_workspace *, const uint8_t *payload,
                     size_t payload_size, int32_t sec, uint32_t nanosec, uint8_t *out, size_t *size);

/* Write the payload of a serialized ROS 2 message at the end of `out`; `size` as above: the payload begins at
 * `out` + room - `size`. */
RL_API int rl_to_proto(const rl_table *, uint32_t translation, rl_workspace *, const uint8_t *cdr, size_t cdr_size,
                       uint8_t *out, size_t *size);

#ifdef __cplusplus
}
#endif
#endif
