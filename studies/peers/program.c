/* A network of two layers. Samples are read from PORT, and outputs written to it. network.h holds
   the sizes and the constants as whole numbers: codes of the weights, biases with the fraction bits
   of a product, and the words of the tables of our bipartite. platform.h says what differs from
   processor to processor: PORT, times, TABLE and the type of a code, and how work is begun. */
#include <stdint.h>

#include "platform.h"

#include "network.h"

/* r with 14 fraction bits, for q with 14; both stand for the middle of their step. */
static int32_t tanh_of(int32_t q)
{
    int32_t sign = q >> 31, mag = q ^ sign, upper, base, slope;
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
    code_t samples[INPUTS], r[HIDDEN];
    int i, j;
    int32_t output;
    int64_t sum;
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
            output = sum >> SECOND_SHIFT;
            PORT = output > 8191 ? 8191 : output < -8192 ? -8192 : output;
        }
    }
}
