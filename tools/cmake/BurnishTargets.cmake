# The one place for warnings, sanitizers and the shape of a library of this project.

# Everything that is compiled here links this; it is never exported.
add_library(burnish_warnings INTERFACE)
target_compile_features(burnish_warnings INTERFACE cxx_std_20)
target_compile_options(burnish_warnings INTERFACE
  $<$<CXX_COMPILER_ID:GNU,Clang>:-Wall -Wextra $<$<BOOL:${BURNISH_WERROR}>:-Werror>>)
if(BURNISH_SANITIZE)
  # Two instruction sets in place of five: see runtime/src/sphere/simd.h.
  target_compile_definitions(burnish_warnings INTERFACE BURNISH_FEW_TARGETS)
  target_compile_options(burnish_warnings INTERFACE
    -fsanitize=${BURNISH_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all
    # g++ warns of what the sanitizers insert, even in std::regex and std::function.
    $<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized>)
  if(BURNISH_SANITIZE MATCHES "undefined")
    # AddressSanitizer finds what object-size could; vptr looks at classes with virtual functions.
    target_compile_options(burnish_warnings INTERFACE -fno-sanitize=object-size,vptr)
  endif()
  target_link_options(burnish_warnings INTERFACE -fsanitize=${BURNISH_SANITIZE})
  # The programs carry their sanitizer options, so that they need no environment.
  target_sources(burnish_warnings INTERFACE
    $<$<STREQUAL:$<TARGET_PROPERTY:TYPE>,EXECUTABLE>:${CMAKE_CURRENT_LIST_DIR}/sanitizer_options.cpp>)
endif()

# burnish_precompiled_headers(NAME LIBRARIES... HEADERS...): with BURNISH_PCH, the target NAME, whose
# precompiled headers others take by burnish_precompile(). The headers are those that nearly every
# source of the others includes anyway: a precompiled one hides that a source forgot to.
function(burnish_precompiled_headers name)
  if(NOT BURNISH_PCH)
    return()
  endif()
  cmake_parse_arguments(arg "" "" "LIBRARIES;HEADERS;OPTIONS" ${ARGN})
  set(source ${CMAKE_CURRENT_BINARY_DIR}/${name}.cpp)
  file(CONFIGURE OUTPUT ${source} CONTENT "")
  add_library(${name} OBJECT ${source})
  target_link_libraries(${name} PRIVATE ${arg_LIBRARIES} burnish_warnings)
  target_compile_options(${name} PRIVATE ${arg_OPTIONS})
  target_precompile_headers(${name} PRIVATE ${arg_HEADERS})
  if(CMAKE_CXX_COMPILER_ID STREQUAL "Clang")  # or ccache never finds them again
    target_compile_options(${name} PRIVATE "SHELL:-Xclang -fno-pch-timestamp")
  endif()
endfunction()

# burnish_precompile(TARGETS... FROM NAME): NAME is of burnish_precompiled_headers(); the targets must
# compile with its options.
function(burnish_precompile)
  cmake_parse_arguments(arg "" "FROM" "" ${ARGN})
  if(BURNISH_PCH)
    foreach(target IN LISTS arg_UNPARSED_ARGUMENTS)
      target_precompile_headers(${target} REUSE_FROM ${arg_FROM})
    endforeach()
  endif()
endfunction()

# burnish_inline_checked(SOURCES...): has clang++ inline all of Eigen in these sources of this folder
# in a sanitized build, where the checks else take most of its functions past the inliner's limit and
# its loops are up to 50 times slower. All checks stay but one: a dangling reference to a local that
# inlining has made a register goes unseen. So for the few hottest sources only.
function(burnish_inline_checked)
  if(BURNISH_SANITIZE AND CMAKE_CXX_COMPILER_ID STREQUAL "Clang")
    set_property(SOURCE ${ARGN} APPEND PROPERTY COMPILE_OPTIONS -mllvm -inline-threshold=2000)
  endif()
endfunction()

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
