# The package that find_package(burnish) reads. The targets are installed by burnish_library().

include(CMakePackageConfigHelpers)

set(BURNISH_INSTALL_CMAKE_DIR ${CMAKE_INSTALL_LIBDIR}/cmake/burnish)

if(BURNISH_INSTALL)
  set(burnish_last_component precompute)
  if(BURNISH_RUNTIME_ONLY)
    set(burnish_last_component runtime)
  endif()
  configure_package_config_file(
    ${CMAKE_CURRENT_LIST_DIR}/burnish-config.cmake.in ${PROJECT_BINARY_DIR}/burnish-config.cmake
    INSTALL_DESTINATION ${BURNISH_INSTALL_CMAKE_DIR} NO_SET_AND_CHECK_MACRO)
  write_basic_package_version_file(
    ${PROJECT_BINARY_DIR}/burnish-config-version.cmake COMPATIBILITY SameMinorVersion)
  install(FILES
    ${PROJECT_BINARY_DIR}/burnish-config.cmake ${PROJECT_BINARY_DIR}/burnish-config-version.cmake
    DESTINATION ${BURNISH_INSTALL_CMAKE_DIR})
  install(FILES ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR})
endif()
