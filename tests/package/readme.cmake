# Compiles the program of the README as it is printed there.
file(READ ${PROJECT_SOURCE_DIR}/README.md readme)
string(REGEX MATCH "```cpp\n([^`]*)```" found "${readme}")
file(CONFIGURE OUTPUT ${CMAKE_CURRENT_BINARY_DIR}/readme_program.cpp CONTENT "${CMAKE_MATCH_1}" @ONLY)
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/README.md)
add_executable(readme_program ${CMAKE_CURRENT_BINARY_DIR}/readme_program.cpp)
target_link_libraries(readme_program PRIVATE curbline::curbline)
target_compile_options(readme_program PRIVATE ${curbline_warnings} -Werror)
add_test(NAME package/the_readme_program_runs COMMAND readme_program)

# Compiles the lines of port/README.md too, as the body of a function.
file(READ ${PROJECT_SOURCE_DIR}/port/README.md readme)
string(REGEX MATCH "```cpp\n(#include [^\n]*\n)([^`]*)```" found "${readme}")
file(CONFIGURE OUTPUT ${CMAKE_CURRENT_BINARY_DIR}/port_readme.cpp @ONLY CONTENT "#include <array>

#include \"curbline/can/signal.hpp\"
#include \"curbline/pipeline.hpp\"
${CMAKE_MATCH_1}
int tilt_from_a_bus(const curbline::can::Signal& signal, curbline::Pipeline<curbline::Limits{}>& pipeline);
int tilt_from_a_bus(const curbline::can::Signal& signal, curbline::Pipeline<curbline::Limits{}>& pipeline) {
${CMAKE_MATCH_2}}
")
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/port/README.md)
add_library(port_readme OBJECT ${CMAKE_CURRENT_BINARY_DIR}/port_readme.cpp)
target_link_libraries(port_readme PRIVATE curbline_socketcan)
target_compile_options(port_readme PRIVATE ${curbline_warnings} -Werror)
