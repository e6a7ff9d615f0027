# Finds the packages burnish needs. Missing ones are collected, so that one configure run names all
# of them, each with its Debian package.

set(burnish_missing "")
set(burnish_missing_debian "")

macro(burnish_note_missing package debian_package)
  list(APPEND burnish_missing ${package})
  list(APPEND burnish_missing_debian ${debian_package})
endmacro()

# burnish_require(PACKAGE DEBIAN_PACKAGE [find_package arguments])
# A macro: some of these packages set plain variables that the caller needs.
macro(burnish_require package debian_package)
  # Debian's Ceres, OpenEXR and HDF5 report every library of theirs in spite of QUIET.
  set(burnish_saved_log_level "${CMAKE_MESSAGE_LOG_LEVEL}")
  set(CMAKE_MESSAGE_LOG_LEVEL WARNING)
  find_package(${package} QUIET ${ARGN})
  set(CMAKE_MESSAGE_LOG_LEVEL "${burnish_saved_log_level}")
  if(${package}_FOUND)
    message(VERBOSE "burnish: ${package} ${${package}_VERSION}")
  else()
    burnish_note_missing(${package} ${debian_package})
  endif()
endmacro()

# Embree 4 where present, else 3.13; either provides the target `embree`.
macro(burnish_require_embree)
  find_package(embree 4 QUIET)
  if(NOT embree_FOUND)
    find_package(embree 3.13 QUIET)
  endif()
  if(embree_FOUND)
    string(REGEX MATCH "^[0-9]+" burnish_embree_major "${embree_VERSION}")
  else()
    burnish_note_missing(embree libembree-dev)
  endif()
endmacro()

# stb_image is a header without a package config; Debian keeps it in <stb/>.
macro(burnish_require_stb)
  find_path(BURNISH_STB_INCLUDE_DIR stb/stb_image.h)
  mark_as_advanced(BURNISH_STB_INCLUDE_DIR)
  if(NOT BURNISH_STB_INCLUDE_DIR)
    burnish_note_missing(stb libstb-dev)
  endif()
endmacro()

# Ends the configure run when a required package was not found.
function(burnish_check_requirements)
  if(burnish_missing)
    set(lines "")
    foreach(package debian_package IN ZIP_LISTS burnish_missing burnish_missing_debian)
      string(APPEND lines "  ${package} (Debian package ${debian_package})\n")
    endforeach()
    list(JOIN burnish_missing_debian " " debian_packages)
    message(FATAL_ERROR "burnish needs packages that were not found:\n${lines}"
                        "On Debian: apt install ${debian_packages}\n"
                        "or run tools/setup, which installs everything.")
  endif()
endfunction()
