/* An AVR in avr_bench.c: it multiplies bytes, its registers GPIOR1 and GPIOR2 are the port, and the
   tables stay in its flash memory. */
#include <avr/io.h>

typedef int16_t code_t;

#define TABLE static const __flash
#define PORT (*(volatile code_t *)&GPIOR1)

void work(void);

int main(void)
{
    work();
}

static int32_t times(int32_t weight, code_t code)
{
    return weight * code;
}
