// Records sinf and cosf of the C library over the finite floats.
//
//     cc -O0 record_sincosf.c -lm -o record && ./record > sincosf.bin
//
// Rows of three little-endian 32-bit words: bits of x, of sinf(x), of cosf(x). First every 1,048,573rd pattern, then
// 6,000 angles spread over +-130 rad, where the lander's angles are. Recorded with glibc 2.36 on x86-64 (Debian 12).
#define _GNU_SOURCE
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

static void row(float x) {
    float values[3] = {x};
    sincosf(x, &values[1], &values[2]);
    fwrite(values, sizeof values[0], 3, stdout);
}

int main(void) {
    for (uint64_t pattern = 0; pattern < 0x100000000ull; pattern += 1048573) {
        uint32_t bits = (uint32_t)pattern;
        float x;
        memcpy(&x, &bits, sizeof x);
        if (isfinite(x)) row(x);
    }
    for (int i = -3000; i < 3000; i++) row((float)i * 0.0433341f);
}
