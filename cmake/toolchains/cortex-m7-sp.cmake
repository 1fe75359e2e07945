# Firmware for a Cortex-M7 with a single-precision FPU.
set(curbline_core "-mcpu=cortex-m7 -mthumb -mfpu=fpv5-sp-d16")
include(${CMAKE_CURRENT_LIST_DIR}/arm-none-eabi.cmake)
