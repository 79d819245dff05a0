/* A network of two layers for a RISC-V without a multiplier. Samples are read from PORT, and outputs
   written to it. network.h holds the sizes and the constants as whole numbers: codes of the weights,
   biases with the fraction bits of a product, and the words of the tables of our bipartite. */
#include "network.h"

#define PORT (*(volatile int *)0x80000000)

void __attribute__((naked, section(".start"))) start(void)
{
    __asm__("li sp, %0\n j work" ::"i"(MEMORY));
}

static int times(int weight, int code)
{
    int product = 0;
    if (code < 0) {
        code = -code;
        weight = -weight;
    }
    for (; code; code >>= 1, weight <<= 1)
        if (code & 1)
            product += weight;
    return product;
}

/* r with 14 fraction bits, for q with 14; both stand for the middle of their step. */
static int tanh_of(int q)
{
    int sign = q >> 31, mag = q ^ sign, upper, base, slope;
    if (mag >> 17)
        mag = 0x1ffff;
    upper = mag >> 15;
    if (upper) {
        base = 512 + ((mag & 0x7f00) >> 6) + upper;
        slope = 1024 + ((mag & 0x7c00) >> 5) + (q >> 3 & 30) + (upper >> 1);
    } else {
        base = mag >> 6;
        slope = ((mag & 0x7c00) >> 5) + (q >> 1 & 31);
    }
    return ((bases[base] ^ sign) + corrections[slope]) >> 3;
}

void __attribute__((noreturn)) work(void)
{
    int samples[INPUTS], r[HIDDEN], i, j;
    long long sum;
    for (;;) {
        for (i = 0; i < INPUTS; i++)
            samples[i] = PORT;
        for (j = 0; j < HIDDEN; j++) {
            sum = first_biases[j];
            for (i = 0; i < INPUTS; i++)
                sum += times(first_weights[j][i], samples[i]);
            r[j] = tanh_of(sum >> FIRST_SHIFT);
        }
        for (j = 0; j < OUTPUTS; j++) {
            sum = second_biases[j];
            for (i = 0; i < HIDDEN; i++)
                sum += times(second_weights[j][i], r[i]);
            i = sum >> SECOND_SHIFT;
            PORT = i > 8191 ? 8191 : i < -8192 ? -8192 : i;
        }
    }
}
