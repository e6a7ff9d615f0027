# Configures the project as if none of its packages were there: the message must name each of them,
# with a Debian package that tools/setup installs.
cmake_minimum_required(VERSION 3.25)

include(${CMAKE_CURRENT_LIST_DIR}/required_packages.cmake)
file(STRINGS ${SOURCE_DIR}/tools/setup setup_lines)
list(JOIN setup_lines " " setup)

required_packages(${SOURCE_DIR} packages)
set(expected "stb (Debian package libstb-dev)")
set(disabled -DCMAKE_IGNORE_PATH=/usr/include)
foreach(package IN LISTS packages)
  string(REGEX MATCH "(.*)\\|(.*)" unused "${package}")
  list(APPEND expected "${CMAKE_MATCH_1} (Debian package ${CMAKE_MATCH_2})")
  list(APPEND disabled -DCMAKE_DISABLE_FIND_PACKAGE_${CMAKE_MATCH_1}=ON)
endforeach()

file(REMOVE_RECURSE ${SCRATCH_DIR})
execute_process(
  COMMAND ${CMAKE_COMMAND} -S ${SOURCE_DIR} -B ${SCRATCH_DIR} -G ${CMAKE_GENERATOR}
    -DCMAKE_C_COMPILER=${CMAKE_C_COMPILER} -DCMAKE_CXX_COMPILER=${CMAKE_CXX_COMPILER} ${disabled}
  RESULT_VARIABLE result OUTPUT_QUIET ERROR_VARIABLE message)
if(result EQUAL 0)
  message(FATAL_ERROR "configuring succeeded without any of the packages")
endif()
foreach(text IN LISTS expected)
  string(FIND "${message}" "${text}" at)
  if(at EQUAL -1)
    message(FATAL_ERROR "the message does not contain '${text}':\n${message}")
  endif()
  string(REGEX REPLACE ".*package (.*)\\)" "\\1" debian_package "${text}")
  if(NOT setup MATCHES "[ (]${debian_package}[ )]")
    message(FATAL_ERROR "tools/setup does not install ${debian_package}")
  endif()
endforeach()
