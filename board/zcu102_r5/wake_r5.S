// Runs on the first Cortex-A53: starts the first R5 at address 0 and sleeps. Only the emulator needs it; on a real
// ZCU102 the first-stage boot loader starts the R5. Source: Arm, Power State Coordination Interface (DEN 0022), CPU_ON.
  .text
  .global _start
_start:
  movz x0, #0x0003
  movk x0, #0xC400, lsl #16  // CPU_ON, 64-bit
  mov x1, #4                 // target: the first of the two R5
  mov x2, #0                 // its first instruction
  mov x3, #0
  smc #0
sleep:
  wfi
  b sleep
