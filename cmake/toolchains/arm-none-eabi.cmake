# Firmware, with Debian's gcc-arm-none-eabi. The file that includes this one sets curbline_core.
set(CMAKE_SYSTEM_NAME Generic)
set(CMAKE_SYSTEM_PROCESSOR arm)
set(CMAKE_CXX_COMPILER arm-none-eabi-g++)
set(CMAKE_C_COMPILER arm-none-eabi-gcc)
set(CMAKE_ASM_COMPILER arm-none-eabi-gcc)
set(CMAKE_TRY_COMPILE_TARGET_TYPE STATIC_LIBRARY)  # nothing links before the board's linker script is known
set(curbline_flags "${curbline_core} -mfloat-abi=hard -ffunction-sections -fdata-sections")
set(CMAKE_C_FLAGS_INIT "${curbline_flags}")
set(CMAKE_ASM_FLAGS_INIT "${curbline_flags}")
# Eigen aligns nothing beyond what the core requires, and refuses to allocate.
set(CMAKE_CXX_FLAGS_INIT "${curbline_flags} -fno-exceptions -fno-rtti -fno-threadsafe-statics -DEIGEN_NO_MALLOC -DEIGEN_DONT_VECTORIZE -DEIGEN_MAX_ALIGN_BYTES=8")
# Without these options -O3 lays out code more than once, loops of more than eight rounds or 100 instructions included: 7.8 kB more flash,
# and no fewer instructions. -g is for tools/budget and takes no flash.
set(CMAKE_CXX_FLAGS_RELEASE "-O3 -fno-split-loops -fno-unswitch-loops --param=max-completely-peel-times=8 \
--param=max-completely-peeled-insns=100 -g -DNDEBUG" CACHE STRING "speed, where it costs no flash")
