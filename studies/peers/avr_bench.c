/* Gives an AVR samples as it takes them, and prints the clock of each sample and of each result.

   Arguments: the name of the AVR, the file of its program, the number of results, and the samples.
   Both bytes of a sample are there when the lower one is read, and a result is complete when its
   lower byte is written, because the compiler writes the upper one first. The last line has the most
   bytes of the stack. */
#include <inttypes.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#include <simavr/sim_avr.h>
#include <simavr/sim_elf.h>
#include <simavr/sim_io.h>

/* The addresses of GPIOR1 and GPIOR2 in data memory. */
#define LOWER 0x4a
#define UPPER 0x4b

static char **samples;
static int count, at, left;

static uint8_t take(avr_t *avr, avr_io_addr_t address, void *unused)
{
    int16_t sample = atoi(samples[at++ % count]);
    printf("taken %" PRIu64 "\n", avr->cycle);
    avr->data[UPPER] = sample >> 8;
    return avr->data[address] = sample;
}

static void give(avr_t *avr, avr_io_addr_t address, uint8_t value, void *unused)
{
    printf("given %" PRIu64 " %d\n", avr->cycle, (int16_t)(avr->data[UPPER] << 8 | value));
    left--;
}

int main(int argc, char **argv)
{
    elf_firmware_t program = {{0}};
    avr_t *avr;
    int state, stack, deepest = 0;
    if (argc < 5 || !(avr = avr_make_mcu_by_name(argv[1])) || elf_read_firmware(argv[2], &program))
        return 2;
    left = atoi(argv[3]);
    samples = argv + 4;
    count = argc - 4;
    avr_init(avr);
    avr_load_firmware(avr, &program);
    avr_register_io_read(avr, LOWER, take, NULL);
    avr_register_io_write(avr, LOWER, give, NULL);
    while (left) {
        state = avr_run(avr);
        if (state == cpu_Done || state == cpu_Crashed) {
            fprintf(stderr, "the program has ended at %x\n", avr->pc);
            return 1;
        }
        stack = avr->ramend - (avr->data[R_SPL] | avr->data[R_SPH] << 8);
        if (stack > deepest)
            deepest = stack;
    }
    printf("stack %d\n", deepest);
    return 0;
}
