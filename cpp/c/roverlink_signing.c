#include "roverlink_signing.h"

#include <string.h>

enum { MAC = 8, TIMESTAMP = 6, VALUE = 1 + TIMESTAMP + MAC, LONGEST_TAG = 5, BLOCK = 64, WORDS = 16 };

static const uint64_t LARGEST_TIMESTAMP = 0xFFFFFFFFFFFFULL;
/* Ten years. A sender that is further ahead has a broken clock. */
static const uint64_t FURTHEST_AHEAD = 10ULL * 365 * 24 * 3600 * ROVERLINK_TICKS_PER_SECOND;

/* --- BLAKE2s, RFC 7693 --- */

/* Section 2.6: the fractional parts of the square roots of the first eight primes. */
static const uint32_t INITIAL[8] = {
  0x6A09E667, 0xBB67AE85, 0x3C6EF372, 0xA54FF53A, 0x510E527F, 0x9B05688C, 0x1F83D9AB, 0x5BE0CD19};

/* Section 2.7: the order of the message's words in each round. */
static const uint8_t ORDER[10][WORDS] = {
  {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15}, {14, 10, 4, 8, 9, 15, 13, 6, 1, 12, 0, 2, 11, 7, 5, 3},
  {11, 8, 12, 0, 5, 2, 15, 13, 10, 14, 3, 6, 7, 1, 9, 4}, {7, 9, 3, 1, 13, 12, 11, 14, 2, 6, 5, 10, 4, 0, 15, 8},
  {9, 0, 5, 7, 2, 4, 10, 15, 14, 1, 11, 12, 6, 8, 3, 13}, {2, 12, 6, 10, 0, 11, 8, 3, 4, 13, 7, 5, 15, 14, 1, 9},
  {12, 5, 1, 15, 14, 13, 4, 10, 0, 7, 6, 3, 9, 2, 8, 11}, {13, 11, 7, 14, 12, 1, 3, 9, 5, 0, 15, 4, 8, 6, 2, 10},
  {6, 15, 14, 9, 11, 3, 0, 8, 12, 2, 13, 7, 1, 4, 10, 5}, {10, 2, 8, 4, 7, 6, 1, 5, 15, 11, 9, 14, 3, 12, 13, 0}};

static uint32_t rotated(uint32_t word, unsigned bits)
{
  return (word >> bits) | (word << (32 - bits));
}

/* Section 3.1. */
static void mix(uint32_t * v, int a, int b, int c, int d, uint32_t x, uint32_t y)
{
  v[a] += v[b] + x;
  v[d] = rotated(v[d] ^ v[a], 16);
  v[c] += v[d];
  v[b] = rotated(v[b] ^ v[c], 12);
  v[a] += v[b] + y;
  v[d] = rotated(v[d] ^ v[a], 8);
  v[c] += v[d];
  v[b] = rotated(v[b] ^ v[c], 7);
}

/* Section 3.2: `end` is the number of bytes up to the end of the block. A datagram is shorter than 4 GiB. */
static void compress(uint32_t * state, const uint8_t * block, uint32_t end, int is_last)
{
  uint32_t v[WORDS], m[WORDS];
  int i;
  for (i = 0; i < WORDS; ++i) {
    const uint8_t * word = block + 4 * i;
    m[i] = (uint32_t)word[0] | (uint32_t)word[1] << 8 | (uint32_t)word[2] << 16 | (uint32_t)word[3] << 24;
    v[i] = i < 8 ? state[i] : INITIAL[i - 8];
  }
  v[12] ^= end;
  v[14] ^= is_last ? 0xFFFFFFFFU : 0;
  for (i = 0; i < 10; ++i) {
    const uint8_t * s = ORDER[i];
    mix(v, 0, 4, 8, 12, m[s[0]], m[s[1]]);
    mix(v, 1, 5, 9, 13, m[s[2]], m[s[3]]);
    mix(v, 2, 6, 10, 14, m[s[4]], m[s[5]]);
    mix(v, 3, 7, 11, 15, m[s[6]], m[s[7]]);
    mix(v, 0, 5, 10, 15, m[s[8]], m[s[9]]);
    mix(v, 1, 6, 11, 12, m[s[10]], m[s[11]]);
    mix(v, 2, 7, 8, 13, m[s[12]], m[s[13]]);
    mix(v, 3, 4, 9, 14, m[s[14]], m[s[15]]);
  }
  for (i = 0; i < 8; ++i) {
    state[i] ^= v[i] ^ v[i + 8];
  }
}

/* Section 3.3: the padded key, if any, is the first block. Digest and key have at most 32 bytes. */
static void blake2s(
  uint8_t * digest, size_t size, const uint8_t * secret, size_t secret_size, const uint8_t * data, size_t length)
{
  uint32_t state[8];
  uint8_t block[BLOCK] = {0};
  uint32_t done = 0;
  size_t position = 0;
  memcpy(state, INITIAL, sizeof state);
  state[0] ^= 0x01010000U ^ (uint32_t)secret_size << 8 ^ (uint32_t)size;
  if (secret_size > 0) {
    memcpy(block, secret, secret_size);
    done = BLOCK;
    compress(state, block, done, length == 0);
  }
  if (secret_size == 0 && length == 0) {
    compress(state, block, 0, 1); /* the only block is empty */
  }
  while (position < length) {
    const size_t part = length - position < sizeof block ? length - position : sizeof block;
    memset(block, 0, sizeof block);
    memcpy(block, data + position, part);
    position += part;
    done += (uint32_t)part;
    compress(state, block, done, position == length);
  }
  for (position = 0; position < size; ++position) {
    digest[position] = (uint8_t)(state[position / 4] >> 8 * (position % 4));
  }
}

/* --- the clock --- */

void roverlink_clock_start(roverlink_clock * clock, uint64_t earliest, uint64_t steady)
{
  clock->last = earliest;
  clock->offset = (int64_t)(earliest - steady);
}

void roverlink_clock_hear(roverlink_clock * clock, uint64_t timestamp, uint64_t steady)
{
  const int64_t offset = (int64_t)(timestamp - steady);
  if (timestamp > clock->last) {
    clock->last = timestamp;
    clock->offset = offset > clock->offset ? offset : clock->offset;
  }
}

uint64_t roverlink_clock_next(roverlink_clock * clock, uint64_t steady)
{
  const uint64_t now = steady + (uint64_t)clock->offset;
  clock->last = now > clock->last ? now : clock->last + 1;
  if (clock->last > LARGEST_TIMESTAMP) {
    clock->last = LARGEST_TIMESTAMP;
  }
  return clock->last;
}

/* --- signatures --- */

int roverlink_key_set(roverlink_key * key, uint8_t id, const char * secret, uint64_t last)
{
  static const char DIGITS[] = "0123456789abcdef";
  size_t i;
  memset(key, 0, sizeof *key);
  key->id = id;
  key->last = last;
  for (i = 0; i < 2 * sizeof key->secret; ++i) {
    const char * digit = secret[i] ? strchr(DIGITS, secret[i]) : NULL;
    if (digit == NULL) {
      return 0;
    }
    key->secret[i / 2] = (uint8_t)(key->secret[i / 2] << 4 | (digit - DIGITS));
  }
  return secret[i] == 0;
}

/* Write the tag and the length of a signature's field; return how many bytes they have. */
static size_t write_start(uint8_t * start, uint32_t number)
{
  uint64_t tag = (uint64_t)number << 3 | 2;
  size_t size = 0;
  for (; tag > 0x7F; tag >>= 7) {
    start[size++] = (uint8_t)(tag | 0x80);
  }
  start[size++] = (uint8_t)tag;
  start[size++] = VALUE;
  return size;
}

size_t roverlink_sign(
  const roverlink_key * key, uint32_t number, uint64_t timestamp, uint8_t * datagram, size_t length, size_t capacity)
{
  uint8_t start[LONGEST_TAG + 1];
  const size_t size = write_start(start, number);
  int i;
  if (length > capacity || capacity - length < size + VALUE) {
    return 0;
  }
  memcpy(datagram + length, start, size);
  length += size;
  datagram[length++] = key->id;
  for (i = 0; i < TIMESTAMP; ++i) {
    datagram[length++] = (uint8_t)(timestamp >> 8 * i);
  }
  blake2s(datagram + length, MAC, key->secret, sizeof key->secret, datagram, length);
  return length + MAC;
}

/* Read a varint and move the position behind it. Bytes beyond the end count as zeros, because they were stripped. */
static uint64_t varint(const uint8_t * data, size_t length, size_t * position)
{
  uint64_t value = 0;
  int i;
  for (i = 0; i < 10; ++i) {
    const uint8_t byte = *position < length ? data[*position] : 0;
    ++*position;
    value |= (uint64_t)(byte & 0x7F) << 7 * i;
    if (!(byte & 0x80)) {
      break;
    }
  }
  return value;
}

/* Find the end of an envelope, which may lie behind the datagram's end, and look for a field in it.
 *
 * The same walk as `fields` in runtime/core/wire_format.py: it ends at the first byte that cannot start a field.
 */
static uint64_t end_of(const uint8_t * data, size_t length, uint32_t number, int * has_field)
{
  uint64_t end = 0;
  *has_field = 0;
  while (end < length && data[end]) {
    size_t position = (size_t)end;
    const uint64_t tag = varint(data, length, &position);
    uint64_t size = 0;
    if (tag >> 3 == 0 || (tag & 7) > 5) {
      break;
    }
    if ((tag & 7) == 0) {
      varint(data, length, &position);
    } else if ((tag & 7) == 1) {
      size = 8;
    } else if ((tag & 7) == 2) {
      size = varint(data, length, &position);
    } else if ((tag & 7) == 5) {
      size = 4;
    }
    *has_field = *has_field || tag >> 3 == number;
    if (size > UINT32_MAX) { /* longer than any datagram; the sum must not overflow */
      return UINT64_MAX;
    }
    end = position + size;
  }
  return end;
}

/* Append zeros that were stripped from an envelope, or leave out zeros that were appended; return the new length.
 *
 * The length stays as it is if the bytes are no envelope, or if the envelope has no room in the buffer.
 */
static size_t restore(uint8_t * data, size_t length, size_t capacity, uint64_t end)
{
  size_t position;
  if (end > length) {
    if (end > capacity) {
      return length;
    }
    memset(data + length, 0, (size_t)end - length);
    return (size_t)end;
  }
  for (position = (size_t)end; position < length; ++position) {
    if (data[position]) {
      return length;
    }
  }
  return (size_t)end;
}

size_t roverlink_restore(uint8_t * datagram, size_t length, size_t capacity)
{
  int has_field;
  return restore(datagram, length, capacity, end_of(datagram, length, 0, &has_field));
}

int roverlink_is_authentic(const roverlink_key * key, const uint8_t * datagram, size_t length)
{
  uint8_t mac[MAC], difference = 0;
  int i;
  blake2s(mac, MAC, key->secret, sizeof key->secret, datagram, length - MAC);
  for (i = 0; i < MAC; ++i) { /* always all bytes: the time must not tell how many were right */
    difference |= (uint8_t)(mac[i] ^ datagram[length - MAC + (size_t)i]);
  }
  return difference == 0;
}

uint64_t roverlink_timestamp(const uint8_t * datagram, size_t length)
{
  uint64_t timestamp = 0;
  int i;
  for (i = 0; i < TIMESTAMP; ++i) {
    timestamp |= (uint64_t)datagram[length - MAC - TIMESTAMP + (size_t)i] << 8 * i;
  }
  return timestamp;
}

roverlink_verdict roverlink_verify(
  roverlink_key * keys, size_t count, uint32_t number, roverlink_clock * clock, uint64_t steady, uint8_t * datagram,
  size_t * length, size_t capacity)
{
  uint8_t start[LONGEST_TAG + 1], id;
  const size_t size = write_start(start, number);
  roverlink_key * key = NULL;
  uint64_t timestamp;
  size_t i;
  int has_field;
  *length = restore(datagram, *length, capacity, end_of(datagram, *length, number, &has_field));
  if (*length < size + VALUE || memcmp(datagram + *length - VALUE - size, start, size) != 0) {
    return has_field ? ROVERLINK_MALFORMED_SIGNATURE : ROVERLINK_UNSIGNED;
  }
  id = datagram[*length - VALUE];
  for (i = 0; i < count; ++i) {
    if (keys[i].id == id) {
      key = keys + i;
    }
  }
  if (key == NULL) {
    return ROVERLINK_UNKNOWN_KEY;
  }
  if (!roverlink_is_authentic(key, datagram, *length)) {
    return ROVERLINK_WRONG_SIGNATURE;
  }
  timestamp = roverlink_timestamp(datagram, *length);
  if (timestamp <= key->last) {
    return timestamp == key->last ? ROVERLINK_REPLAYED : ROVERLINK_OUTDATED;
  }
  /* A board that has heard no time yet believes any. */
  if (clock->last != 0 && timestamp > clock->last && timestamp - clock->last > FURTHEST_AHEAD) {
    return ROVERLINK_AHEAD;
  }
  roverlink_clock_hear(clock, timestamp, steady);
  key->last = timestamp;
  return ROVERLINK_ACCEPTED;
}
