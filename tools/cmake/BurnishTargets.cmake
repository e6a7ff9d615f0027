# The one place for warnings, sanitizers and the shape of a library of this project.

add_library(burnish_warnings INTERFACE)
target_compile_options(burnish_warnings INTERFACE
  $<$<CXX_COMPILER_ID:GNU,Clang>:-Wall -Wextra $<$<BOOL:${BURNISH_WERROR}>:-Werror>>)
if(BURNISH_SANITIZE)
  target_compile_options(burnish_warnings INTERFACE
    -fsanitize=${BURNISH_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all)
  target_link_options(burnish_warnings INTERFACE -fsanitize=${BURNISH_SANITIZE})
endif()

# burnish_library(NAME SOURCES...): the static library burnish::NAME of this folder.
function(burnish_library name)
  add_library(burnish_${name} STATIC ${ARGN})
  add_library(burnish::${name} ALIAS burnish_${name})
  set_target_properties(burnish_${name} PROPERTIES EXPORT_NAME ${name} POSITION_INDEPENDENT_CODE ON)
  target_compile_features(burnish_${name} PUBLIC cxx_std_20)
  target_link_libraries(burnish_${name} PRIVATE $<BUILD_INTERFACE:burnish_warnings>)
  target_include_directories(burnish_${name} PUBLIC
    $<BUILD_INTERFACE:${CMAKE_CURRENT_SOURCE_DIR}/include> $<INSTALL_INTERFACE:include>)
endfunction()
