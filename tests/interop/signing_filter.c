/* The functions of roverlink_signing.c as a filter: a line of signing_vectors.tsv in, what the functions make of it out. */
#include "hexadecimal.h"
#include "roverlink_signing.c"

#include <stdio.h>
#include <stdlib.h>

static const char * const VERDICTS[] = {"accepted",  "unsigned", "malformed_signature", "unknown_key", "wrong_signature",
                                        "replayed", "outdated", "ahead"};

int main(void)
{
  static char line[1 << 18];
  static uint8_t bytes[1 << 17];
  while (fgets(line, sizeof line, stdin)) {
    const char * words[7];
    int count = 0;
    char * rest = line;
    line[strcspn(line, "\n")] = 0;
    while (count < 7 && rest) {
      char * tab = strchr(rest, '\t');
      words[count++] = rest;
      rest = tab ? tab + 1 : NULL;
      if (tab) {
        *tab = 0;
      }
    }
    if (strcmp(words[0], "blake2s") == 0) {
      uint8_t secret[32], digest[32];
      const size_t size = (size_t)atoi(words[1]), secret_size = unhex(words[2], secret);
      blake2s(digest, size, secret, secret_size, bytes, unhex(words[3], bytes));
      print(digest, size);
    } else {
      roverlink_key key = {0};
      const uint32_t number = (uint32_t)atol(words[1]);
      const uint64_t timestamp = strtoull(words[4], NULL, 10);
      size_t length = unhex(words[5], bytes);
      key.id = (uint8_t)atoi(words[2]);
      unhex(words[3], key.secret);
      if (strcmp(words[0], "sign") == 0) {
        print(bytes, roverlink_sign(&key, number, timestamp, bytes, length, sizeof bytes));
      } else {
        roverlink_clock clock;
        roverlink_clock_start(&clock, timestamp, 0);
        key.last = timestamp;
        printf("%s", VERDICTS[roverlink_verify(&key, 1, number, &clock, 0, bytes, &length, sizeof bytes)]);
      }
    }
    printf("\n");
  }
  return 0;
}
