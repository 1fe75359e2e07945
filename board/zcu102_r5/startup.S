// From reset to C++ on a Cortex-R5F. Sources: Armv7-A and -R Architecture Reference Manual, B1.8.1 (vectors), B4.1.40 (CPACR), B4.1.58
// (FPEXC), B4.1.130 (SCTLR).
  .syntax unified
  .arm
  .fpu vfpv3-d16

  .section .vectors, "ax"
  .global vectors
vectors:
  b reset
  b unexpected  // undefined instruction
  b unexpected  // supervisor call: the emulator handles those of semihosting before they get here
  b unexpected  // prefetch abort
  b unexpected  // data abort
  b unexpected
  b unexpected  // IRQ
  b unexpected  // FIQ

  .text
  .global reset
reset:
  cpsid if
  mrc p15, 0, r0, c1, c0, 0   // SCTLR
  bic r0, r0, #(1 << 13)      // V: vectors at 0
  mcr p15, 0, r0, c1, c0, 0
  mrc p15, 0, r0, c1, c0, 2   // CPACR: full access to CP10 and CP11, the FPU
  orr r0, r0, #(0xF << 20)
  mcr p15, 0, r0, c1, c0, 2
  isb
  mov r0, #(1 << 30)          // FPEXC.EN
  vmsr fpexc, r0
  ldr sp, =stack_end
  bl start
  b .

  // From any mode: reuses the whole stack, since nothing returns.
unexpected:
  ldr sp, =stack_end
  bl unexpected_exception
  b .
