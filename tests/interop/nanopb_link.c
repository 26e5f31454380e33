/* A board in a pipe that exchanges link messages with nanopb and the generated roverlink_link.h.

   A command is one letter and a time of eight bytes in microseconds, little endian.
   's': sends link messages until all rows are told; each comes as two bytes of length, and its bytes; then length 0.
   'd': sends another datagram, which nobody sees.
   't': takes the envelope that follows as two bytes of length and its bytes; answers with one byte, what take returned. */

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

#include <pb_decode.h>
#include <pb_encode.h>

#include "linked/envelope.pb.h"
#include "roverlink_link.h"

static uint8_t buffer[2048];

static uint64_t number(int bytes) {
  uint64_t value = 0;
  for (int i = 0; i < bytes; i++) value |= (uint64_t)getchar() << (8 * i);
  return value;
}

static void put(size_t length) {
  putchar((int)(length & 0xFF));
  putchar((int)(length >> 8));
}

int main(void) {
  roverlink_link link;
  roverlink_link_start(&link, roverlink_rows_hardware_Drive, ROVERLINK_COUNT(roverlink_rows_hardware_Drive), 4711);
  int command;
  while ((command = getchar()) != EOF) {
    uint64_t now_us = number(8);
    linked_Envelope envelope = linked_Envelope_init_zero;
    if (command == 's') {
      bool more;
      do {
        envelope.which_payload = linked_Envelope_link_tag;
        more = roverlink_link_fill(&link, now_us, &envelope.payload.link);
        pb_ostream_t out = pb_ostream_from_buffer(buffer, sizeof buffer);
        if (!pb_encode(&out, linked_Envelope_fields, &envelope)) return 1;
        put(out.bytes_written);
        fwrite(buffer, 1, out.bytes_written, stdout);
      } while (more);
      put(0);
    } else if (command == 'd') {
      link.sent++;
    } else {
      size_t length = (size_t)number(2);
      if (fread(buffer, 1, length, stdin) != length) return 1;
      pb_istream_t in = pb_istream_from_buffer(buffer, length);
      if (!pb_decode(&in, linked_Envelope_fields, &envelope)) return 1;
      if (envelope.which_payload != linked_Envelope_link_tag) return 1;
      putchar(roverlink_link_take(&link, now_us, &envelope.payload.link));
    }
    fflush(stdout);
  }
  return 0;
}
