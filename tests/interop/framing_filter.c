/* The functions of roverlink_framing.c as a filter of lines: "write DATAGRAM" to its frame; "read CAPACITY BYTES" to the
   datagrams in the bytes and the count of refused frames. All bytes are hexadecimal. */
#include "hexadecimal.h"
#include "roverlink_framing.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

int main(void)
{
  static char line[1 << 18];
  static uint8_t bytes[1 << 17];
  while (fgets(line, sizeof line, stdin)) {
    char * end;
    if (line[0] == 'w') {
      const size_t length = unhex(line + 6, bytes), room = ROVERLINK_FRAME_SIZE(length);
      uint8_t * frame = malloc(room);
      const size_t size = roverlink_frame_write(frame, room, bytes, length);
      if (roverlink_frame_write(frame, room - 1, bytes, length) != 0) return 1;
      print(frame, size);
      free(frame);
    } else {
      const size_t capacity = strtoul(line + 5, &end, 10), size = unhex(end + 1, bytes);
      uint8_t * buffer = malloc(capacity);
      roverlink_frames frames;
      size_t i;
      roverlink_frames_start(&frames, buffer, capacity);
      for (i = 0; i < size; ++i) {
        if (roverlink_frames_take(&frames, bytes[i])) {
          print(frames.datagram, frames.length);
          printf(",");
        }
      }
      printf("%u", (unsigned)frames.refused);
      free(buffer);
    }
    printf("\n");
  }
  return 0;
}
