/* A test on the ATmega328P of simavr. The result goes to the serial port as a letter, A for 0. Sleep without interrupts
 * ends the simulation. */
#include <avr/interrupt.h>
#include <avr/io.h>
#include <avr/sleep.h>

int code_test(void);

static void send(char letter) {
  while ((UCSR0A & (1u << UDRE0)) == 0u) {
  }
  UDR0 = (uint8_t)letter;
}

int main(void) {
  const int wrong = code_test();

  UCSR0B = (uint8_t)(1u << TXEN0);
  send((char)('A' + ((wrong < 25) ? wrong : 25)));
  send('\n');
  while ((UCSR0A & (1u << UDRE0)) == 0u) {
  }
  cli();
  sleep_mode();
  return 0;
}
