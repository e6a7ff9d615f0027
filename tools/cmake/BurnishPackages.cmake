# Finds the packages, and names the Debian package of each that is missing.

macro(burnish_require package debian_package)
  find_package(${package} QUIET ${ARGN})
  if(NOT ${package}_FOUND)
    message(FATAL_ERROR "burnish needs ${package}, which was not found. On Debian: "
                        "apt install ${debian_package} (or run tools/setup, which installs everything).")
  endif()
endmacro()

# Embree 4 where present, else Embree 3.13: the target `burnish_embree` stands for either.
macro(burnish_require_embree)
  find_package(embree 4 QUIET)
  if(NOT embree_FOUND)
    find_package(embree 3.13 QUIET)
  endif()
  if(NOT embree_FOUND)
    message(FATAL_ERROR "burnish needs Embree 3.13 or 4, which was not found. On Debian: "
                        "apt install libembree-dev (or run tools/setup, which installs everything).")
  endif()
endmacro()

# stb_image is a single header; Debian keeps it in <stb/>.
macro(burnish_require_stb)
  find_path(BURNISH_STB_INCLUDE_DIR stb/stb_image.h)
  if(NOT BURNISH_STB_INCLUDE_DIR)
    message(FATAL_ERROR "burnish needs stb_image.h, which was not found. On Debian: "
                        "apt install libstb-dev (or run tools/setup, which installs everything).")
  endif()
endmacro()
