/* A board in a pipe that must sign: it takes signed notes, as nanopb_echo.c does, and answers each with a signed one. */

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <pb_decode.h>
#include <pb_encode.h>

#include "roverlink_signing.h"

#include ENVELOPE_HEADER

static uint8_t buffer[512];
static roverlink_key of_bridge = {2, {0}, 0};
static roverlink_key own;

static void put(size_t length) {
  putchar((int)(length & 0xFF));
  putchar((int)(length >> 8));
}

static bool answer(roverlink_clock *clock, size_t *length) {
  ENVELOPE envelope;
  memset(&envelope, 0, sizeof envelope);
  if (roverlink_verify(&of_bridge, 1, SIGNATURE_TAG, clock, 0, buffer, length, sizeof buffer) != ROVERLINK_ACCEPTED) {
    return false;
  }
  pb_istream_t in = pb_istream_from_buffer(buffer, *length);
  if (!pb_decode(&in, ENVELOPE_FIELDS, &envelope)) return false;
  envelope.signature.size = 0; /* it was that of the bridge */
  pb_ostream_t out = pb_ostream_from_buffer(buffer, sizeof buffer);
  if (!pb_encode(&out, ENVELOPE_FIELDS, &envelope)) return false;
  *length = roverlink_sign(
      &own, SIGNATURE_TAG, roverlink_clock_next(clock, 0), buffer, out.bytes_written, sizeof buffer);
  return *length != 0;
}

int main(void) {
  int low, high;
  roverlink_clock clock;
  roverlink_clock_start(&clock, 0, 0); /* a board without a clock: it learns the time from the bridge */
  if (!roverlink_key_set(&own, 1, "0101010101010101010101010101010101010101010101010101010101010101", 0)) return 1;
  memset(of_bridge.secret, 2, sizeof of_bridge.secret);
  while ((low = getchar()) != EOF && (high = getchar()) != EOF) {
    size_t length = (size_t)low | (size_t)high << 8;
    if (fread(buffer, 1, length, stdin) != length) return 1;
    if (answer(&clock, &length)) {
      put(length);
      fwrite(buffer, 1, length, stdout);
    } else {
      put(0xFFFF);
    }
    fflush(stdout);
  }
  return 0;
}
