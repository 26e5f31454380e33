/* A board in a pipe: decodes each envelope with nanopb into its own structs, encodes those, and writes that back.

   An envelope comes and goes as two bytes of length, little endian, and its bytes. A length of 0xFFFF goes back for one
   that nanopb does not take. */

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <pb_decode.h>
#include <pb_encode.h>

#include ENVELOPE_HEADER

static uint8_t buffer[65536];

static void put(size_t length) {
  putchar((int)(length & 0xFF));
  putchar((int)(length >> 8));
}

int main(void) {
  int low, high;
  while ((low = getchar()) != EOF && (high = getchar()) != EOF) {
    size_t length = (size_t)low | (size_t)high << 8;
    if (fread(buffer, 1, length, stdin) != length) return 1;
    ENVELOPE envelope;
    memset(&envelope, 0, sizeof envelope);
    pb_istream_t in = pb_istream_from_buffer(buffer, length);
    bool taken = pb_decode(&in, ENVELOPE_FIELDS, &envelope);
    if (!taken) fprintf(stderr, "%s\n", PB_GET_ERROR(&in));
    pb_ostream_t out = pb_ostream_from_buffer(buffer, sizeof buffer);
    if (taken && pb_encode(&out, ENVELOPE_FIELDS, &envelope)) {
      put(out.bytes_written);
      fwrite(buffer, 1, out.bytes_written, stdout);
    } else {
      put(0xFFFF);
    }
    fflush(stdout);
  }
  return 0;
}
