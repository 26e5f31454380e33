/* The way of a datagram through a bridge without Python: from the socket to topics and to other peers, and from topics
 * to peers.
 *
 * `rl_receive` and `rl_serve` run on threads of their own. What they cannot do, they hand to Python with a call: a datagram of a row that
 * it does not translate, one that is not exactly an envelope with one payload, and a value that does not fit. Python
 * then does all that it would do without this library, so that counts and texts are the same.
 *
 * All structs are memory of Python. Python writes the members marked "P" while the thread runs, and reads those marked
 * "N", which only the thread writes.
 */
#ifndef ROVERLINK_BRIDGE_H
#define ROVERLINK_BRIDGE_H

#include <sys/uio.h>

#include "roverlink/native.h"
#include "roverlink_signing.h" /* of cpp/c: what boards use */

#ifdef __cplusplus
extern "C" {
#endif

#define RL_BURST 8     /* datagrams that are published at once, below the depth (10) of most subscriptions */
#define RL_SLOTS 64    /* datagrams that one system call reads */
#define RL_BUCKETS 16  /* of the histogram of latencies, at most */

typedef struct rl_datagram {
  const uint8_t *data;
  size_t size;
  const void *sender; /* struct sockaddr; null for a datagram that did not come from the socket */
  size_t sender_size;
} rl_datagram;

#define RL_RAW 0x80000000u /* flag of a record's channel: a datagram that is no envelope without its missing zeros, or
                               because of zeros behind it */

/* Copies of messages and datagrams for observers such as a recorder, as records: the number of bytes and the channel (two
 * uint32_t), the time in nanoseconds of the monotonic clock (int64_t), and the bytes, filled up to a multiple of eight.
 * What finds no room is handed to Python, which first empties the ring. */
typedef struct rl_ring {
  uint8_t *memory;
  uint64_t room;     /* bytes */
  uint64_t written;  /* N: bytes since the start */
  uint64_t read;     /* bytes since the start, by `rl_take_records` */
} rl_ring;

/* Copy all records to `out`, which has the room of the ring, and remove them. Returns the number of bytes. */
RL_API size_t rl_take_records(rl_ring *, uint8_t *out);

/* Set the member of each channel of which there are records: the place of the newest one, plus 1. */
RL_API void rl_newest_records(const uint8_t *records, size_t size, uint64_t *places);

/* Records that `rl_take_records` gave, and what a file in the format MCAP gets of them. */
typedef struct rl_recording {
  const uint8_t *records;
  size_t size;              /* bytes of the records */
  const uint16_t *channels; /* by the channel of a record: the channel in the file, or 0 for none. What has RL_RAW goes
                               to the channel behind it. */
  int64_t log_time, publish_time; /* what to add to the time of a record, in nanoseconds */
} rl_recording;

/* Records of one channel of the file. */
typedef struct rl_run {
  uint32_t channel, count;
  uint64_t first; /* index of the first one, when they are sorted by channel; 0 for `rl_record` */
} rl_run;

/* Fill `runs`, in the order of the first record of each; there is room for all channels. Returns their number. */
RL_API uint32_t rl_count_records(const rl_recording *, rl_run *runs);

/* Write the records as Message records to `out`, which has twice their room. Fill `index` with two numbers for each, sorted
 * by channel as `runs`: its time, and its place, the first one at `offset`. Returns the number of bytes. */
RL_API size_t rl_record(const rl_recording *, rl_run *runs, uint32_t n_runs, uint64_t offset, uint8_t *out,
                        uint64_t *index);

/* Lock between threads of Python and of the core. No thread of the core calls Python while it has one. */
typedef struct rl_lock {
  uint32_t state; /* 0: free */
} rl_lock;

RL_API void rl_lock_take(rl_lock *);
RL_API int rl_lock_try(rl_lock *); /* 1, or 0 if another thread has it */
RL_API void rl_lock_leave(rl_lock *);

/* Clock of the timestamps of a link: SigningClock in runtime/core/signing.py. Used under the lock. */
typedef struct rl_clock {
  roverlink_clock now;
  rl_lock *lock;
} rl_clock;

/* Key of a peer, with what was accepted: Stream in runtime/core/signing.py. Python judges what the core does not accept,
 * and changes the members meanwhile, which is safe because it does so on the thread of `rl_receive`. */
typedef struct rl_stream {
  roverlink_key key;
  uint64_t plausible; /* Python looks at later timestamps */
  rl_clock *clock;
} rl_stream;

/* Key with which the bridge signs. The lock is held while datagrams are signed and sent, so that their order stays. */
typedef struct rl_signer {
  roverlink_key key;
  rl_clock *clock;
  rl_lock *lock;
  uint32_t number;       /* of the envelope's field */
  uint32_t strips_zeros; /* 1 if the peer gets its datagrams without the zeros at their end */
} rl_signer;
/* Allocator of rcl: rcutils_allocator_t. */
typedef struct rl_rcl_allocator {
  void *(*allocate)(size_t, void *state);
  void (*deallocate)(void *, void *state);
  void *(*reallocate)(void *, size_t, void *state);
  void *(*zero_allocate)(size_t count, size_t, void *state);
  void *state;
} rl_rcl_allocator;

/* Serialized message of rcl: rcutils_uint8_array_t, whose allocator is not used for publishing. */
typedef struct rl_rcl_message {
  uint8_t *buffer;
  size_t length, capacity;
  rl_rcl_allocator allocator;
} rl_rcl_message;

/* Functions of the middleware's library: those of Cyclone DDS, or the one of rcl. */
typedef struct rl_middleware {
  void *(*serdata)(const void *sertype, int kind, size_t count, const struct iovec *, size_t size);
  int32_t (*write)(int32_t writer, void *serdata);
  int32_t (*flush)(int32_t writer);
  int32_t (*publish)(const void *publisher, const rl_rcl_message *, void *allocation);
  int32_t (*count_subscriptions)(const void *publisher, size_t *count);
} rl_middleware;

/* Limit of the rate of a row: Pacer in runtime/bridge/limited_row.py, which passes on the message that waits. Used under the
 * lock, which Python also holds while it passes a message on. */
typedef struct rl_pacer {
  double interval, slot; /* seconds; the slot is the time at which the next message may pass */
  uint64_t waits;        /* 1 if a message waits */
  uint64_t size;         /* of the message that waits; 0 if it is in Python's memory */
  uint64_t room;
  uint8_t *message;
  rl_lock *lock;
  uint64_t superseded;   /* N: messages that a newer one has replaced */
} rl_pacer;

/* Topic on which a row's payloads are published. */
typedef struct rl_topic {
  uint32_t translation;
  uint32_t wanted;        /* P: 1 if the topic has subscribers, or keeps messages for later ones */
  int32_t writer;         /* of Cyclone DDS, with the type of its samples */
  uint32_t observed;      /* 1 if observers get the messages; the channel is the index of the topic */
  const void *sertype;
  const void *publisher;  /* of rcl */
  rl_pacer *pacer;        /* null without a limit */
  int64_t paused_until;   /* in nanoseconds of the monotonic clock: no message is published before */
  uint64_t published;     /* N */
  int64_t published_at;   /* N: time of the last message, in nanoseconds of the monotonic clock */
} rl_topic;

typedef struct rl_row {
  uint32_t number;        /* of the envelope's field; the rows are sorted by it */
  uint32_t native;        /* P: 0 hands the datagrams of the row over */
  uint32_t at_once;       /* the row's datagrams are handed over before any later one is handled */
  uint32_t first_topic;   /* the row's own topic; behind it are the extra topics */
  uint32_t topics;
  uint32_t longest;       /* longer datagrams are handed over, unless all are forwarded as they are */
  uint32_t is_signed;     /* 1 if the datagrams have to be signed */
  uint32_t unused;
  uint64_t signers[4];    /* bit by the id of each key that may sign them */
  uint64_t forward;       /* bit by destination */
  struct rl_pacer *const *forward_pacers; /* by destination, null without a limit; null if no forward has one */
  uint64_t handled;       /* N: datagrams */
} rl_row;

/* End of the link to which datagrams are forwarded. */
typedef struct rl_destination {
  const int32_t *socket;  /* P: connected; -1 if Python has to send */
  const rl_signer *signer; /* null if nothing is signed */
  uint64_t forwarded;     /* N */
  uint32_t segments;      /* 1 if the kernel has UDP_SEGMENT */
  uint32_t unused;
} rl_destination;

/* Limit of a sender's rate: Source in runtime/net/sources.py, which takes tokens on the thread of `rl_receive`, too. */
typedef struct rl_bucket {
  double rate;              /* tokens a second; infinity for no limit */
  double burst, allowance;  /* tokens, one for each datagram */
  double at;                /* time of the last change, in seconds of the monotonic clock */
} rl_bucket;

/* Calls of Python. All but the first get the index of a topic or a destination. Each but the last returns 0; any other
 * number ends `rl_receive`. */
typedef struct rl_calls {
  int (*handle)(const rl_datagram *, uint32_t count); /* without datagrams: once in two seconds while some arrive */
  int (*not_published)(uint32_t topic);
  int (*wait)(uint32_t topic); /* a message waits for its time */
  int (*send)(uint32_t destination, const rl_datagram *, uint32_t count);
  /* the bucket of a sender if Python need not see its datagrams of a row as long as it has tokens, until `senders`
   * changes; null to hand one over */
  rl_bucket *(*admit)(uint32_t row, const rl_datagram *);
} rl_calls;

typedef struct rl_bridge {
  const rl_table *table;
  rl_workspace *workspace;
  rl_topic *topics;
  rl_row *rows;
  rl_destination *destinations;
  rl_stream *const *streams;
  rl_middleware middleware;
  rl_calls calls;
  rl_ring *observers;          /* null without observers */
  const double *bounds;        /* of the buckets of the histogram, in seconds */
  uint64_t latencies[RL_BUCKETS]; /* N: datagrams by the time that their burst needed */
  double latency_sum;          /* N: seconds */
  uint64_t received;           /* N: datagrams that were not handed over */
  uint32_t n_topics, n_rows, n_destinations, n_bounds, n_streams;
  uint32_t signature;          /* number of the envelope's field with the signature */
  int32_t socket, wake;        /* file descriptors */
  uint32_t largest;            /* longest datagram that is read; longer ones are cut */
  uint32_t observed;           /* 1 if observers get the datagrams, on the channel behind those of the topics */
  uint32_t checks_senders;     /* P: 1 if a row's datagrams need an admitted sender */
  uint32_t senders;            /* P: changes if what was admitted holds no longer */
  uint32_t forwards_all;       /* P: 1 if all destinations get all datagrams as they are */
  uint32_t is_ordered;         /* 1 if no datagram may be handled before an earlier one that is handed over */
  uint32_t stopping;           /* P: 1 makes `rl_receive` return, also if datagrams arrive all the time */
} rl_bridge;

/* RL_OK, or RL_WRONG_TABLE if an index leads out of an array. */
RL_API int rl_check_bridge(const rl_bridge *);

/* Handle datagrams until `stopping` is set or `wake` has data. Returns 0, what a call of Python returned if that was not 0, or -1 if memory
 * is short. */
RL_API int rl_receive(rl_bridge *);

/* Sample info of Cyclone DDS: dds_sample_info_t. */
typedef struct rl_sample_info {
  uint32_t sample_state, view_state, instance_state;
  uint8_t valid_data;
  int64_t source_timestamp;
  uint64_t instance_handle, publication_handle;
  uint32_t counts[5];
} rl_sample_info;

/* Functions of the middleware's library: those of Cyclone DDS, or the one of rcl. */
typedef struct rl_reading {
  int32_t (*wait)(int32_t waitset, intptr_t *triggered, size_t most, int64_t timeout);
  int32_t (*take)(int32_t reader, void **serdata, uint32_t most, rl_sample_info *, uint32_t mask);
  uint32_t (*size)(const void *serdata);
  void (*bytes)(const void *serdata, size_t first, size_t size, void *out);
  void (*unref)(void *serdata);
  int32_t (*take_one)(const void *subscription, rl_rcl_message *, void *info, void *allocation);
  void *(*new_listener)(void *argument);
  void (*on_data_available)(void *listener, void (*)(int32_t reader, void *argument));
  int32_t (*set_listener)(int32_t reader, const void *listener); /* waits for calls of the one before */
  void (*delete_listener)(void *);
  int32_t (*set_guard)(int32_t condition, bool triggered);
} rl_reading;

/* Topic whose messages go to a peer. */
typedef struct rl_subscription {
  uint32_t translation;
  uint32_t number;         /* of the envelope's field */
  int32_t reader;          /* of Cyclone DDS */
  uint32_t native;         /* P: 0 hands the messages over, and also datagrams that are not sent yet */
  const int32_t *socket;   /* P: see rl_destination */
  const rl_signer *signer; /* null if nothing is signed */
  rl_pacer *pacer;         /* null without a limit */
  uint32_t segments;
  uint32_t observed;       /* bits: 1 if observers get the messages, on channel 2 * index; 2 if they get the datagrams, on
                              the next channel */
  uint32_t strips_zeros;   /* 1 if the peer gets its datagrams without the zeros at their end */
  uint32_t is_direct;      /* 1 if the thread of Cyclone DDS that receives a single message may send it: nothing is
                              signed, limited or observed */
  uint64_t taken, sent;    /* N */
  int64_t sent_at;         /* N: time of the last datagram, in nanoseconds of the monotonic clock */
  const void *subscription; /* of rcl */
  uint32_t arrived;        /* 1 from `rl_arrived` until the thread looks for messages */
  int32_t wake;            /* of rcl: what `rl_server` waits for */
} rl_subscription;

/* Tell the thread that a message has arrived: the callback of rcl for new messages. */
RL_API void rl_arrived(const void *subscription, size_t count);

/* Calls of Python; `topic` is an index in `topics`. Each returns 0; any other number ends `rl_serve`. */
typedef struct rl_serving_calls {
  int (*serve)(uint32_t topic, uint32_t most);  /* take and handle messages of a topic that Python reads */
  int (*take)(uint32_t topic, const rl_datagram *message);  /* handle a message that was taken */
  int (*wait)(uint32_t topic);  /* a message waits for its time */
  int (*send)(uint32_t topic, const rl_datagram *);  /* send a datagram that could not be sent */
} rl_serving_calls;

typedef struct rl_server {
  const rl_table *table;
  rl_workspace *workspace;
  rl_subscription *const *topics;  /* the most urgent first; null for one that Python reads */
  const int32_t *priorities;       /* of the topics */
  rl_reading reading;
  rl_serving_calls calls;
  rl_ring *observers;              /* null without observers */
  rl_workspace *direct_workspace;  /* for the threads of Cyclone DDS */
  uint32_t n_topics;
  int32_t waitset;                 /* of Cyclone DDS: what triggers it is an index in `topics`, or -1 for `wake`; direct
                                      topics do not trigger it. With rcl, an eventfd, and each topic has an
                                      rl_subscription */
  int32_t wake;                    /* guard condition of Cyclone DDS: for `stopping`, and for direct topics */
  uint32_t stopping;               /* P: 1 makes `rl_serve` return */
} rl_server;

/* Take messages and send them until `stopping` is set. Returns as `rl_receive` does. */
RL_API int rl_serve(rl_server *);

#ifdef __cplusplus
}
#endif
#endif
