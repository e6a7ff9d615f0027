# build_consumer(PROJECT_DIR BUILD_DIR): configures a project against the burnish that is installed
# in PREFIX, with the compilers and flags of the calling script, and builds it. With PACKAGES,
# separated by commas, find_package() may find no others.
function(build_consumer project_dir build_dir)
  set(flags "")
  if(BURNISH_SANITIZE)
    set(flags "-fsanitize=${BURNISH_SANITIZE}")
  endif()
  set(disabled "")
  if(PACKAGES)
    string(REPLACE "," ";" packages "${PACKAGES}")
    foreach(package OpenMesh OpenEXR Imath PNG HDF5 nlohmann_json fmt embree TBB Ceres CLI11 GTest
            hwy benchmark rapidcheck)
      if(NOT package IN_LIST packages)
        list(APPEND disabled -DCMAKE_DISABLE_FIND_PACKAGE_${package}=ON)
      endif()
    endforeach()
  endif()

  execute_process(
    COMMAND ${CMAKE_COMMAND} -S ${project_dir} -B ${build_dir} -G ${CMAKE_GENERATOR}
      -DCMAKE_PREFIX_PATH=${PREFIX} -DCMAKE_BUILD_TYPE=${CMAKE_BUILD_TYPE}
      -DCMAKE_CXX_COMPILER=${CMAKE_CXX_COMPILER}
      -DCMAKE_CXX_COMPILER_LAUNCHER=${CMAKE_CXX_COMPILER_LAUNCHER}
      -DCMAKE_CXX_FLAGS=${flags} ${disabled} --no-warn-unused-cli
    COMMAND_ERROR_IS_FATAL ANY)
  execute_process(COMMAND ${CMAKE_COMMAND} --build ${build_dir} COMMAND_ERROR_IS_FATAL ANY)
endfunction()
