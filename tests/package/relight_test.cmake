# Builds the example program EXAMPLE_DIR against the burnish that is installed in PREFIX and runs it
# on a bake of its own: two squares of floor, far from each other, one of them below a roof.
cmake_minimum_required(VERSION 3.25)

include(${CMAKE_CURRENT_LIST_DIR}/consumer.cmake)
file(REMOVE_RECURSE ${SCRATCH_DIR})
build_consumer(${EXAMPLE_DIR} ${SCRATCH_DIR}/build)

file(WRITE ${SCRATCH_DIR}/floor.obj "v -1 0 -1\nv -1 0 1\nv 1 0 1\nv 1 0 -1\n"
  "v 19 0 -1\nv 19 0 1\nv 21 0 1\nv 21 0 -1\nf 1 2 3 4\nf 5 6 7 8\n")
file(WRITE ${SCRATCH_DIR}/roof.obj "v -9 2 -9\nv -9 2 9\nv 9 2 9\nv 9 2 -9\nf 1 2 3 4\n")
execute_process(
  COMMAND ${PREFIX}/bin/burnish bake floor.obj --occluders roof.obj -o floor.h5 --quiet
    --directions 64 --resolution 32 --terms 4 --bases 1 --ladder-terms 0
  WORKING_DIRECTORY ${SCRATCH_DIR} COMMAND_ERROR_IS_FATAL ANY)
# A disc in the zenith, about which the lights turn.
file(WRITE ${SCRATCH_DIR}/zenith.json "{\"format\": \"burnish lights\", \"format_version\": 2,
  \"directionals\": [{\"toward\": [0, 1, 0], \"angular_radius_rad\": 0.1,
    \"irradiance\": [1, 1, 1]}]}\n")
# Two pixels of radiance 64 / 256 * 2^(127 - 128) = 0.125.
string(ASCII 64 64 64 127 64 64 64 127 pixels)
file(WRITE ${SCRATCH_DIR}/grey.hdr "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 2\n${pixels}")

# The mean radiance that the program prints, with these arguments, must lie in [lowest, highest].
function(expect_mean lowest highest)
  execute_process(
    COMMAND ${SCRATCH_DIR}/build/relight floor.h5 zenith.json ${ARGN}
    WORKING_DIRECTORY ${SCRATCH_DIR} OUTPUT_VARIABLE printed COMMAND_ERROR_IS_FATAL ANY)
  if(NOT printed MATCHES "^mean radiance ([0-9.]+)\n[0-9.]+ frames/s\n$" OR
     CMAKE_MATCH_1 LESS lowest OR CMAKE_MATCH_1 GREATER highest)
    message(FATAL_ERROR "printed '${printed}', expected a mean in [${lowest}, ${highest}]")
  endif()
endfunction()

# Half the vertices see the zenith; of them, a tile of albedo 0.7 has the radiance 0.7 / pi, hence
# 0.111408 in the mean. Its highlight is nowhere near (below 1e-6: half vectors are 25 degrees and
# more from the normal, alpha is 0.071). Float rounding and the printed decimals stay below 2e-6.
expect_mean(0.111406 0.111410 "ceramic tile")
# A map adds highlights of at most the reflectance 0.05 times 0.125, on that half.
expect_mean(0.111450 0.114533 "ceramic tile" grey.hdr)
