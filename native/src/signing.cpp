// The C code of boards, of which the library has a copy of its own.
#ifndef __clang__  // GCC unrolls the rounds of the hash only so: they then take less than half the time
#pragma GCC optimize("O3")
#endif
#include "roverlink_signing.c"
