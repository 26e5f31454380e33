/* Bytes as hexadecimal text, for the filters that call the functions of boards. */
#include <stdint.h>
#include <stdio.h>

static size_t unhex(const char * text, uint8_t * bytes)
{
  size_t size = 0;
  unsigned byte;
  for (; sscanf(text, "%2x", &byte) == 1; text += 2) {
    bytes[size++] = (uint8_t)byte;
  }
  return size;
}

static void print(const uint8_t * bytes, size_t size)
{
  size_t i;
  for (i = 0; i < size; ++i) {
    printf("%02x", bytes[i]);
  }
}
