/* Frames of datagrams on a serial line, for the firmware of a board. No memory is allocated, and no function waits.
 *
 * A frame is the datagram and its CRC-16 (two bytes, the high one first), encoded with COBS, which leaves no zero in them,
 * and a zero at the end. The CRC is CRC-16/CCITT-FALSE: polynomial 0x1021, initial value 0xFFFF, no reflection.
 * runtime/net/transports/framing.py in roverlink has the same format; both are tested with each other.
 */
#ifndef ROVERLINK_FRAMING_H_
#define ROVERLINK_FRAMING_H_

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Bytes of the CRC behind a datagram. */
#define ROVERLINK_FRAME_CHECK 2

/* Largest size of the frame of a datagram of `length` bytes: COBS adds a byte for each 254 bytes or less. */
#define ROVERLINK_FRAME_SIZE(length) \
  ((length) + ROVERLINK_FRAME_CHECK + ((length) + ROVERLINK_FRAME_CHECK + 253) / 254 + 1)

/* Write the frame of a datagram; the two buffers must not overlap.
 *
 * Returns the length of the frame, or 0 if `capacity` is less than ROVERLINK_FRAME_SIZE(length).
 */
size_t roverlink_frame_write(uint8_t * frame, size_t capacity, const uint8_t * datagram, size_t length);

/* Reader of the bytes of a serial line. It may start anywhere: what is not a whole frame is refused until the next zero. */
typedef struct {
  uint8_t * datagram; /* The datagram, after roverlink_frame_take has returned 1, until the next byte is taken. */
  size_t length;
  uint32_t refused; /* Frames that were damaged, or too large for the buffer. */
  /* The rest belongs to the functions. */
  size_t capacity;
  size_t filled;
  uint16_t crc;
  uint8_t code; /* The last code byte of COBS. */
  uint8_t left; /* Bytes up to the next one. */
  uint8_t is_begun;
} roverlink_frames;

/* Start reading; `buffer` needs room for the largest datagram and ROVERLINK_FRAME_CHECK bytes. */
void roverlink_frames_start(roverlink_frames * frames, uint8_t * buffer, size_t capacity);

/* Take the next byte of the line; return 1 if it ends the frame of a datagram, which has arrived whole. */
int roverlink_frames_take(roverlink_frames * frames, uint8_t byte);

#ifdef __cplusplus
}
#endif

#endif /* ROVERLINK_FRAMING_H_ */
