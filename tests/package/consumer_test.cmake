# Configures PROJECT_DIR against the burnish that is installed in PREFIX, builds its program and runs
# it. The one number it prints must lie between LOWEST and HIGHEST. With PACKAGES, separated by
# commas, find_package() may find no others.
cmake_minimum_required(VERSION 3.25)

include(${CMAKE_CURRENT_LIST_DIR}/consumer.cmake)
file(REMOVE_RECURSE ${SCRATCH_DIR})
build_consumer(${PROJECT_DIR} ${SCRATCH_DIR}/build)
execute_process(
  COMMAND ${SCRATCH_DIR}/build/consumer
  WORKING_DIRECTORY ${SCRATCH_DIR}
  OUTPUT_VARIABLE printed OUTPUT_STRIP_TRAILING_WHITESPACE COMMAND_ERROR_IS_FATAL ANY)

if(NOT printed MATCHES "^[0-9.e+-]+$" OR printed LESS LOWEST OR printed GREATER HIGHEST)
  message(FATAL_ERROR "printed '${printed}', expected a number in [${LOWEST}, ${HIGHEST}]")
endif()
