/* SERV in serv_system.v: it has no multiplier, begins at address 0, and has MEMORY bytes. */
typedef int32_t code_t;

#define TABLE static const
#define PORT (*(volatile code_t *)0x80000000)

void __attribute__((naked, section(".start"))) start(void)
{
    __asm__("li sp, %0\n j work" ::"i"(MEMORY));
}

static int32_t times(int32_t weight, code_t code)
{
    int32_t product = 0;
    if (code < 0) {
        code = -code;
        weight = -weight;
    }
    for (; code; code >>= 1, weight <<= 1)
        if (code & 1)
            product += weight;
    return product;
}
