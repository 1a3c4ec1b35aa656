/* Start of a test on the Cortex-M4 that qemu calls mps2-an386. The result goes to qemu by semihosting. */
#include <stdint.h>

int code_test(void);
extern uint32_t stack_top[];

static void finish(int code) {
  /* SYS_EXIT_EXTENDED: the reason "application exit", and the exit code. */
  uint32_t block[2] = {0x20026u, (uint32_t)code};
  register uint32_t operation __asm__("r0") = 0x20u;
  register uint32_t* argument __asm__("r1") = block;
  __asm__ volatile("bkpt 0xab" : : "r"(operation), "r"(argument) : "memory");
  for (;;) {
  }
}

void start(void) {
  /* Coprocessors 10 and 11, the floating-point unit: full access (CPACR). */
  *(volatile uint32_t*)0xe000ed88u |= 0xfu << 20;
  __asm__ volatile("dsb\n isb");
  finish(code_test());
}

void onFault(void) { finish(127); }

typedef void (*Handler)(void);
struct VectorTable {
  uint32_t* stack;
  Handler handlers[6];
};
__attribute__((section(".vectors"), used)) static const struct VectorTable vectors = {
    stack_top, {start, onFault, onFault, onFault, onFault, onFault}};
