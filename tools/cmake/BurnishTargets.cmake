# The one place for warnings, sanitizers and the shape of a library of this project.

# Everything that is compiled here links this; it is never exported.
add_library(burnish_warnings INTERFACE)
target_compile_features(burnish_warnings INTERFACE cxx_std_20)
target_compile_options(burnish_warnings INTERFACE
  $<$<CXX_COMPILER_ID:GNU,Clang>:-Wall -Wextra $<$<BOOL:${BURNISH_WERROR}>:-Werror>>)
if(BURNISH_SANITIZE)
  target_compile_options(burnish_warnings INTERFACE
    -fsanitize=${BURNISH_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all
    # g++ warns of what the sanitizers insert, even in std::regex and std::function.
    $<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized>)
  target_link_options(burnish_warnings INTERFACE -fsanitize=${BURNISH_SANITIZE})
  # The programs carry their sanitizer options, so that they need no environment.
  target_sources(burnish_warnings INTERFACE
    $<$<STREQUAL:$<TARGET_PROPERTY:TYPE>,EXECUTABLE>:${CMAKE_CURRENT_LIST_DIR}/sanitizer_options.cpp>)
endif()

# burnish_library(NAME SOURCES...): the static library burnish::NAME of this folder. Its public
# headers are those below include/, and all of them are installed.
function(burnish_library name)
  file(GLOB_RECURSE headers CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/include/*.h)
  add_library(burnish_${name} STATIC ${ARGN})
  add_library(burnish::${name} ALIAS burnish_${name})
  set_target_properties(burnish_${name} PROPERTIES EXPORT_NAME ${name} POSITION_INDEPENDENT_CODE ON)
  target_compile_features(burnish_${name} PUBLIC cxx_std_20)
  target_link_libraries(burnish_${name} PRIVATE $<BUILD_INTERFACE:burnish_warnings>)
  target_sources(burnish_${name} PUBLIC
    FILE_SET HEADERS BASE_DIRS ${CMAKE_CURRENT_SOURCE_DIR}/include FILES ${headers})
  if(BURNISH_INSTALL)
    # An export set for each library: find_package() then looks only for what its components need.
    install(TARGETS burnish_${name} EXPORT burnish-${name}-targets FILE_SET HEADERS)
    install(EXPORT burnish-${name}-targets NAMESPACE burnish::
      DESTINATION ${BURNISH_INSTALL_CMAKE_DIR})
  endif()
endfunction()
