# Firmware for a Cortex-M4 with its single-precision FPU.
set(curbline_core "-mcpu=cortex-m4 -mthumb -mfpu=fpv4-sp-d16")
include(${CMAKE_CURRENT_LIST_DIR}/arm-none-eabi.cmake)
