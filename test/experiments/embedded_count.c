/* Counts the instructions of each answer on the Cortex-M4 that qemu calls mps2-an386, started with -icount shift=10.
 * One instruction then takes 1024 ns, which are 25.6 ticks of the 25 MHz SysTick. Writes a line for each input:
 * status, instructions, and the first input as ANSWER makes it an integer. Numbers are written in hexadecimal. */
#include <stdint.h>

#include "embedded_inputs.h"

/* Returns 0 where u is an answer. */
int embeddedAnswer(const REAL theta[PARAMETER_COUNT], REAL u[ANSWER_COUNT]);

extern uint32_t stack_top[];

static uint32_t callHost(uint32_t operation, const void* argument) {
  register uint32_t r0 __asm__("r0") = operation;
  register const void* r1 __asm__("r1") = argument;
  __asm__ volatile("bkpt 0xab" : "+r"(r0) : "r"(r1) : "memory");
  return r0;
}

static void writeNumber(uint32_t value, char end) {
  char text[10];
  int i;
  for (i = 0; i < 8; ++i) text[i] = "0123456789abcdef"[(value >> (28 - 4 * i)) & 15u];
  text[8] = end;
  text[9] = '\0';
  callHost(0x04u, text);
}

/* Falls by one each tick. */
static volatile uint32_t* const current_ticks = (volatile uint32_t*)0xe000e018u;
#define TICK_RANGE 0x1000000u

static uint32_t instructionsOf(uint32_t start, uint32_t end) {
  const uint32_t ticks = (start - end) & (TICK_RANGE - 1u);
  return (ticks * 10u + 128u) / 256u;
}

static int noAnswer(const REAL theta[PARAMETER_COUNT], REAL u[ANSWER_COUNT]) {
  (void)theta;
  (void)u;
  return 0;
}

__attribute__((noinline)) static void count(void) {
  int (*volatile none)(const REAL*, REAL*) = noAnswer;
  int (*volatile answer)(const REAL*, REAL*) = embeddedAnswer;
  uint32_t overhead;
  unsigned int i;
  uint32_t block[2] = {0x20026u, 0u};
  /* SysTick: greatest period, processor clock, no interrupt. */
  *(volatile uint32_t*)0xe000e014u = TICK_RANGE - 1u;
  *(volatile uint32_t*)0xe000e010u = 5u;
  {
    REAL u[ANSWER_COUNT] = {0};
    const uint32_t before = *current_ticks;
    (void)none(inputs[0], u);
    overhead = instructionsOf(before, *current_ticks);
  }
  for (i = 0u; i < INPUT_COUNT; ++i) {
    REAL u[ANSWER_COUNT] = {0};
    const uint32_t before = *current_ticks;
    const int status = answer(inputs[i], u);
    const uint32_t after = *current_ticks;
    writeNumber((uint32_t)status, ' ');
    writeNumber(instructionsOf(before, after) - overhead, ' ');
    writeNumber((uint32_t)ANSWER(u[0]), '\n');
  }
  callHost(0x20u, block);
  for (;;) {
  }
}

void start(void) {
  /* Coprocessors 10 and 11, the floating-point unit: full access (CPACR), before the first function that saves one of
   * its registers. */
  *(volatile uint32_t*)0xe000ed88u |= 0xfu << 20;
  __asm__ volatile("dsb\n isb");
  count();
}

static void onFault(void) {
  uint32_t block[2] = {0x20026u, 127u};
  callHost(0x20u, block);
  for (;;) {
  }
}

typedef void (*Handler)(void);
struct VectorTable {
  uint32_t* stack;
  Handler handlers[6];
};
__attribute__((section(".vectors"), used)) static const struct VectorTable vectors = {
    stack_top, {start, onFault, onFault, onFault, onFault, onFault}};
