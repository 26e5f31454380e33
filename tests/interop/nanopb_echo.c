/* A board in a pipe: decodes each envelope with nanopb into its own structs, encodes those, and writes that back.

   An envelope comes and goes as two bytes of length, little endian, and its bytes. A length of 0xFFFF goes back for one
   that nanopb does not take. With SIGNED, the envelopes that come must be signed by the bridge, and the board signs. */

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <pb_decode.h>
#include <pb_encode.h>

#include ENVELOPE_HEADER

static uint8_t buffer[65536];

#ifdef SIGNED
#include "roverlink_signing.h"

static roverlink_key of_bridge = {2, {0}, 0};
static roverlink_key own;
static roverlink_clock board_clock; /* a board without a clock: it learns the time from the bridge */

static bool start(void) {
  roverlink_clock_start(&board_clock, 0, 0);
  memset(of_bridge.secret, 2, sizeof of_bridge.secret);
  return roverlink_key_set(&own, 1, "0101010101010101010101010101010101010101010101010101010101010101", 0);
}

static bool verify(size_t *length) {
  return roverlink_verify(&of_bridge, 1, SIGNATURE_TAG, &board_clock, 0, buffer, length, sizeof buffer) ==
         ROVERLINK_ACCEPTED;
}

static size_t sign(size_t length) {
  return roverlink_sign(&own, SIGNATURE_TAG, roverlink_clock_next(&board_clock, 0), buffer, length, sizeof buffer);
}
#else
static bool start(void) { return true; }
static bool verify(size_t *length) { return length != NULL; }
static size_t sign(size_t length) { return length; }
#endif

static bool echo(size_t *length) {
  ENVELOPE envelope;
  memset(&envelope, 0, sizeof envelope);
  if (!verify(length)) return false;
  pb_istream_t in = pb_istream_from_buffer(buffer, *length);
  if (!pb_decode(&in, ENVELOPE_FIELDS, &envelope)) return false;
#ifdef SIGNED
  envelope.signature.size = 0; /* it was that of the bridge */
#endif
  pb_ostream_t out = pb_ostream_from_buffer(buffer, sizeof buffer);
  if (!pb_encode(&out, ENVELOPE_FIELDS, &envelope)) return false;
  *length = sign(out.bytes_written);
  return *length != 0 || out.bytes_written == 0;
}

int main(void) {
  int low, high;
  if (!start()) return 1;
  while ((low = getchar()) != EOF && (high = getchar()) != EOF) {
    size_t length = (size_t)low | (size_t)high << 8;
    if (fread(buffer, 1, length, stdin) != length) return 1;
    bool taken = echo(&length);
    putchar(taken ? (int)(length & 0xFF) : 0xFF);
    putchar(taken ? (int)(length >> 8) : 0xFF);
    if (taken) fwrite(buffer, 1, length, stdout);
    fflush(stdout);
  }
  return 0;
}
