# Configures PROJECT_DIR against the burnish that is installed in PREFIX, builds its program and runs
# it. The one number it prints must lie between LOWEST and HIGHEST. With PACKAGES, separated by
# commas, find_package() may find no others.
cmake_minimum_required(VERSION 3.25)

set(build_dir ${SCRATCH_DIR}/build)
file(REMOVE_RECURSE ${SCRATCH_DIR})

set(flags "")
if(BURNISH_SANITIZE)
  set(flags "-fsanitize=${BURNISH_SANITIZE}")
endif()
set(disabled "")
if(PACKAGES)
  string(REPLACE "," ";" PACKAGES "${PACKAGES}")
  foreach(package OpenMesh OpenEXR Imath PNG HDF5 nlohmann_json fmt embree TBB Ceres CLI11 GTest
          hwy benchmark rapidcheck)
    if(NOT package IN_LIST PACKAGES)
      list(APPEND disabled -DCMAKE_DISABLE_FIND_PACKAGE_${package}=ON)
    endif()
  endforeach()
endif()

execute_process(
  COMMAND ${CMAKE_COMMAND} -S ${PROJECT_DIR} -B ${build_dir} -G ${CMAKE_GENERATOR}
    -DCMAKE_PREFIX_PATH=${PREFIX} -DCMAKE_BUILD_TYPE=${CMAKE_BUILD_TYPE}
    -DCMAKE_CXX_COMPILER=${CMAKE_CXX_COMPILER}
    -DCMAKE_CXX_COMPILER_LAUNCHER=${CMAKE_CXX_COMPILER_LAUNCHER}
    -DCMAKE_CXX_FLAGS=${flags} ${disabled} --no-warn-unused-cli
  COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND ${CMAKE_COMMAND} --build ${build_dir} COMMAND_ERROR_IS_FATAL ANY)
execute_process(
  COMMAND ${build_dir}/consumer
  WORKING_DIRECTORY ${SCRATCH_DIR}
  OUTPUT_VARIABLE printed OUTPUT_STRIP_TRAILING_WHITESPACE COMMAND_ERROR_IS_FATAL ANY)

if(NOT printed MATCHES "^[0-9.e+-]+$" OR printed LESS LOWEST OR printed GREATER HIGHEST)
  message(FATAL_ERROR "printed '${printed}', expected a number in [${LOWEST}, ${HIGHEST}]")
endif()
