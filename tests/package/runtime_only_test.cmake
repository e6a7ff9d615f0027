# Configures the runtime alone, with every other package hidden, builds it and installs it to PREFIX.
# Such an installation must refuse the components that it has not, by name.
cmake_minimum_required(VERSION 3.25)

include(${CMAKE_CURRENT_LIST_DIR}/required_packages.cmake)
required_packages(${SOURCE_DIR} packages)
set(disabled "")
foreach(package IN LISTS packages)
  string(REGEX REPLACE "\\|.*" "" package "${package}")
  if(NOT package MATCHES "^(Eigen3|hwy)$")
    list(APPEND disabled -DCMAKE_DISABLE_FIND_PACKAGE_${package}=ON)
  endif()
endforeach()

file(REMOVE_RECURSE ${SCRATCH_DIR})
execute_process(
  COMMAND ${CMAKE_COMMAND} -S ${SOURCE_DIR} -B ${SCRATCH_DIR}/build -G ${CMAKE_GENERATOR}
    -DBURNISH_RUNTIME_ONLY=ON -DBURNISH_BUILD_TESTS=OFF -DCMAKE_BUILD_TYPE=${CMAKE_BUILD_TYPE}
    -DCMAKE_C_COMPILER=${CMAKE_C_COMPILER} -DCMAKE_CXX_COMPILER=${CMAKE_CXX_COMPILER}
    -DCMAKE_CXX_COMPILER_LAUNCHER=${CMAKE_CXX_COMPILER_LAUNCHER}
    -DBURNISH_WERROR=${BURNISH_WERROR}
    -DCMAKE_IGNORE_PATH=/usr/include ${disabled} --no-warn-unused-cli
  COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND ${CMAKE_COMMAND} --build ${SCRATCH_DIR}/build COMMAND_ERROR_IS_FATAL ANY)
execute_process(
  COMMAND ${CMAKE_COMMAND} --install ${SCRATCH_DIR}/build --prefix ${PREFIX}
  OUTPUT_QUIET COMMAND_ERROR_IS_FATAL ANY)

file(WRITE ${SCRATCH_DIR}/formats/CMakeLists.txt "cmake_minimum_required(VERSION 3.25)
project(wants_formats LANGUAGES CXX)
find_package(burnish REQUIRED COMPONENTS formats)\n")
execute_process(
  COMMAND ${CMAKE_COMMAND} -S ${SCRATCH_DIR}/formats -B ${SCRATCH_DIR}/formats/build
    -G ${CMAKE_GENERATOR} -DCMAKE_CXX_COMPILER=${CMAKE_CXX_COMPILER} -DCMAKE_PREFIX_PATH=${PREFIX}
  RESULT_VARIABLE result OUTPUT_QUIET ERROR_VARIABLE message)
if(result EQUAL 0 OR NOT message MATCHES "built[ \n]+without[ \n]+formats")
  message(FATAL_ERROR "asked for formats, which is not there, the package says:\n${message}")
endif()
