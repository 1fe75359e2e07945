# Firmware for a Cortex-R5 with a double-precision FPU.
set(curbline_core "-mcpu=cortex-r5 -mthumb -mfpu=vfpv3-d16")
include(${CMAKE_CURRENT_LIST_DIR}/arm-none-eabi.cmake)
