/* Signatures of datagrams, for the firmware of a board. No memory is allocated, and no clock is read.
 *
 * The format, the rules and the names are those of runtime/core/signing.py in roverlink; docs/security.md explains how to
 * use them. All three implementations are tested with the same vectors, signing_vectors.tsv.
 */
#ifndef ROVERLINK_SIGNING_H_
#define ROVERLINK_SIGNING_H_

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

enum {
  /* Bytes that a signature adds to a datagram, if its field number is below 16, below 2048, and at most. */
  ROVERLINK_SIGNED_15 = 17,
  ROVERLINK_SIGNED_2047 = 18,
  ROVERLINK_SIGNED_ANY = 21,
  ROVERLINK_SECRET_BYTES = 32,
  ROVERLINK_TICKS_PER_SECOND = 100000
};

/* Clock of timestamps. They count 10 us since 2015-01-01 UTC, and never go back.
 *
 * The functions get the `steady` time: 10 us since the start of the board, from a timer that is never set back.
 */
typedef struct {
  uint64_t last;   /* The latest timestamp that was used, or heard of the other end. */
  int64_t offset;  /* Timestamp at the steady time 0. */
} roverlink_clock;

/* Start the clock.
 *
 * `earliest` is the stored `last` of the previous run, plus ROVERLINK_TICKS_PER_SECOND if it is stored once a second.
 * A board that stores nothing gives 0. Its datagrams are refused until it has verified a datagram of the other end.
 */
void roverlink_clock_start(roverlink_clock * clock, uint64_t earliest, uint64_t steady);

/* Continue from a timestamp if it is later: the time of a GPS receiver, for example. roverlink_verify does this, too. */
void roverlink_clock_hear(roverlink_clock * clock, uint64_t timestamp, uint64_t steady);

/* Return the timestamp of the next datagram. */
uint64_t roverlink_clock_next(roverlink_clock * clock, uint64_t steady);

/* Key of one sender, as `roverlink link keygen` writes it. */
typedef struct {
  uint8_t id;
  uint8_t secret[ROVERLINK_SECRET_BYTES];
  uint64_t last; /* The latest timestamp that was accepted. Store it once a second, as that of the clock. */
} roverlink_key;

/* Set a key from the id and the secret in a key file; `last` is the stored timestamp, or 0.
 *
 * Returns 0 if the secret does not have 64 hexadecimal digits in lower case.
 */
int roverlink_key_set(roverlink_key * key, uint8_t id, const char * secret, uint64_t last);

/* Append a signature to a serialized envelope.
 *
 * `number` is the field number of the signature, such as PBEnvelope_signature_tag. Returns the length of the signed
 * datagram, or 0 if it has no room in `capacity` bytes.
 */
size_t roverlink_sign(
  const roverlink_key * key, uint32_t number, uint64_t timestamp, uint8_t * datagram, size_t length, size_t capacity);

/* Result of a verification. The names of the reasons are those of the bridge's account. */
typedef enum {
  ROVERLINK_ACCEPTED,
  ROVERLINK_UNSIGNED,
  ROVERLINK_MALFORMED_SIGNATURE,
  ROVERLINK_UNKNOWN_KEY,
  ROVERLINK_WRONG_SIGNATURE,
  ROVERLINK_REPLAYED,
  ROVERLINK_OUTDATED,
  ROVERLINK_AHEAD
} roverlink_verdict;

/* Accept or refuse a datagram; obey it only if the result is ROVERLINK_ACCEPTED.
 *
 * `keys` are the keys that the other end may sign with: two during a rotation. Zeros at the end of the datagram that were
 * stripped or appended are restored in the buffer, which has `capacity` bytes; `length` becomes the length of the
 * envelope.
 */
roverlink_verdict roverlink_verify(
  roverlink_key * keys, size_t count, uint32_t number, roverlink_clock * clock, uint64_t steady, uint8_t * datagram,
  size_t * length, size_t capacity);

/* The parts of roverlink_verify, for a program that decides about timestamps by itself, such as the bridge. */

/* Restore the zeros at the end of an envelope in a buffer of `capacity` bytes; return the length of the envelope.
 *
 * The length stays as it is if the bytes are no envelope, or if the envelope has no room. Only bytes behind the datagram
 * change.
 */
size_t roverlink_restore(uint8_t * datagram, size_t length, size_t capacity);

/* Return 1 if the last bytes of a datagram are the MAC of the key over all before; the datagram has a whole signature. */
int roverlink_is_authentic(const roverlink_key * key, const uint8_t * datagram, size_t length);

/* Return the timestamp in a datagram with a whole signature. */
uint64_t roverlink_timestamp(const uint8_t * datagram, size_t length);

#ifdef __cplusplus
}
#endif

#endif /* ROVERLINK_SIGNING_H_ */
