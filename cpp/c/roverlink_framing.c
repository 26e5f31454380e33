#include "roverlink_framing.h"

enum { INITIAL_CRC = 0xFFFF, LONGEST_BLOCK = 0xFF };

/* CRC of the bytes so far and of the next one. The shifts are what eight steps with the polynomial 0x1021 come to. */
static uint16_t updated(uint16_t crc, uint8_t byte)
{
  uint32_t high = ((uint32_t)crc >> 8) ^ byte;
  high ^= high >> 4;
  return (uint16_t)(((uint32_t)crc << 8) ^ (high << 12) ^ (high << 5) ^ high);
}

size_t roverlink_frame_write(uint8_t * frame, size_t capacity, const uint8_t * datagram, size_t length)
{
  size_t block = 0, used = 1, i; /* `block`: where the code byte of the current block belongs. */
  uint16_t crc = INITIAL_CRC;
  if (length > capacity || capacity < ROVERLINK_FRAME_SIZE(length)) {
    return 0;
  }
  for (i = 0; i < length; ++i) {
    crc = updated(crc, datagram[i]);
  }
  for (i = 0; i < length + ROVERLINK_FRAME_CHECK; ++i) {
    const uint8_t byte = i < length ? datagram[i] : (uint8_t)(i == length ? crc >> 8 : crc & 0xFF);
    if (used - block == LONGEST_BLOCK) { /* A block of this length has no zero behind it. */
      frame[block] = LONGEST_BLOCK;
      block = used++;
    }
    if (byte != 0) {
      frame[used++] = byte;
    } else {
      frame[block] = (uint8_t)(used - block);
      block = used++;
    }
  }
  frame[block] = (uint8_t)(used - block);
  frame[used++] = 0;
  return used;
}

static void begin(roverlink_frames * frames)
{
  frames->filled = 0;
  frames->crc = INITIAL_CRC;
  frames->code = LONGEST_BLOCK; /* No zero stands before the first block. */
  frames->left = 0;
  frames->is_begun = 0;
}

void roverlink_frames_start(roverlink_frames * frames, uint8_t * buffer, size_t capacity)
{
  frames->datagram = buffer;
  frames->capacity = capacity;
  frames->length = 0;
  frames->refused = 0;
  begin(frames);
}

static void put(roverlink_frames * frames, uint8_t byte)
{
  if (frames->filled < frames->capacity) {
    frames->datagram[frames->filled] = byte;
  }
  frames->filled += frames->filled <= frames->capacity; /* One more than the capacity: the frame is too large. */
  frames->crc = updated(frames->crc, byte);
}

int roverlink_frames_take(roverlink_frames * frames, uint8_t byte)
{
  if (byte == 0) {
    /* The CRC of the bytes with their CRC behind them is 0. */
    const int is_whole = frames->left == 0 && frames->crc == 0 && frames->filled >= ROVERLINK_FRAME_CHECK &&
                         frames->filled <= frames->capacity;
    frames->length = is_whole ? frames->filled - ROVERLINK_FRAME_CHECK : 0;
    frames->refused += (uint32_t)(frames->is_begun && !is_whole); /* Zeros in a row are no frames. */
    begin(frames);
    return is_whole;
  }
  frames->is_begun = 1;
  if (frames->left == 0) {
    if (frames->code != LONGEST_BLOCK) {
      put(frames, 0);
    }
    frames->code = byte;
    frames->left = (uint8_t)(byte - 1);
  } else {
    put(frames, byte);
    --frames->left;
  }
  return 0;
}
