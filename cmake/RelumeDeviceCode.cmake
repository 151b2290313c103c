# Device code: the PTX of all kernels, compiled by clang without NVIDIA's headers and tools.
set(RELUME_CUDA AUTO CACHE STRING "Compile the kernels to PTX: AUTO (if clang++ 14 or later is found), ON or OFF")
set_property(CACHE RELUME_CUDA PROPERTY STRINGS AUTO ON OFF)

include(RelumeFindClang)
include(RelumeKernelLists)

# Folders list their kernels. all_kernels.inc includes these lists.
set(RELUME_DEVICE_FOLDER ${PROJECT_BINARY_DIR}/device)
relume_find_kernel_lists(${PROJECT_SOURCE_DIR}/src kernel_lists)
list(TRANSFORM kernel_lists REPLACE "(.+)" "#include \"\\1\"")
list(JOIN kernel_lists "\n" kernel_lists)
file(CONFIGURE OUTPUT ${RELUME_DEVICE_FOLDER}/all_kernels.inc CONTENT "${kernel_lists}\n")
file(CONFIGURE OUTPUT ${RELUME_DEVICE_FOLDER}/kernels.cu CONTENT
  "#include \"frame/cuda/device_entry.h\"\n\n#include \"all_kernels.inc\"\n")

# Sets `missing` to the reason why there is no device code, or to nothing. Sets RELUME_CLANG and RELUME_CLANG_FLAGS.
function(relume_find_device_compiler)
  relume_find_clang(RELUME_CLANG)
  if(NOT RELUME_CLANG)
    set(missing "clang++ 14 or later is not installed" PARENT_SCOPE)
    return()
  endif()
  relume_clang_version(${RELUME_CLANG} version)
  if(NOT version VERSION_GREATER_EQUAL 14)
    set(missing "${RELUME_CLANG} is not version 14 or later" PARENT_SCOPE)
    return()
  endif()
  set(flags
    -x cuda --cuda-device-only -nocudainc -nocudalib --cuda-gpu-arch=sm_75
    -std=c++20 -O2 -DNDEBUG
    # As on the host: no fused multiply-add.
    -ffp-contract=off -fno-math-errno
    -I${PROJECT_SOURCE_DIR}/include -I${PROJECT_SOURCE_DIR}/src -include frame/cuda/device_shim.h
    -DGLM_FORCE_CUDA -DGLM_FORCE_SILENT_WARNINGS
    # An installed CUDA, of any version, is not used.
    -Wno-unknown-cuda-version
    -S)
  # Version 14 writes PTX 6.3 for this architecture. Later ones write newer versions, which old drivers refuse.
  if(version VERSION_GREATER_EQUAL 15)
    list(APPEND flags --cuda-feature=+ptx63)
  endif()
  # A second /usr/include would hide the C library's headers from the C++ library.
  if(NOT GLM_INCLUDE_DIR IN_LIST CMAKE_CXX_IMPLICIT_INCLUDE_DIRECTORIES)
    list(APPEND flags -isystem ${GLM_INCLUDE_DIR})
  endif()
  file(WRITE ${RELUME_DEVICE_FOLDER}/probe.cu "#include <cmath>\n__global__ void probe(float* x) { *x = std::sqrt(*x); }\n")
  execute_process(COMMAND ${RELUME_CLANG} ${flags} ${RELUME_DEVICE_FOLDER}/probe.cu -o ${RELUME_DEVICE_FOLDER}/probe.ptx
    RESULT_VARIABLE result OUTPUT_QUIET ERROR_VARIABLE errors)
  if(NOT result EQUAL 0)
    string(REGEX REPLACE "\n.*" "" errors "${errors}")
    set(missing "${RELUME_CLANG} cannot compile device code: ${errors}" PARENT_SCOPE)
    return()
  endif()
  set(missing "" PARENT_SCOPE)
  set(RELUME_CLANG_FLAGS ${flags} PARENT_SCOPE)
endfunction()

# RELUME_PTX: the device code, or empty. RELUME_COMPRESSED_PTX: the form that the library contains.
set(RELUME_PTX "")
if(RELUME_CUDA AND RELUME_STANDARD_MATH)
  message(FATAL_ERROR "RELUME_STANDARD_MATH=ON replaces elementary functions on the host only; set RELUME_CUDA=OFF")
endif()
if(RELUME_CUDA)
  relume_find_device_compiler()
  if(missing AND RELUME_CUDA STREQUAL "AUTO")
    message(STATUS "No device code: ${missing}")
  elseif(missing)
    message(FATAL_ERROR "RELUME_CUDA=${RELUME_CUDA}, but ${missing}; install clang or set RELUME_CUDA=OFF")
  else()
    set(RELUME_PTX ${RELUME_DEVICE_FOLDER}/relume.ptx)
    add_custom_command(OUTPUT ${RELUME_PTX} DEPENDS ${RELUME_DEVICE_FOLDER}/kernels.cu VERBATIM
      DEPFILE ${RELUME_PTX}.d COMMENT "Compiling kernels to ${RELUME_PTX}"
      COMMAND ${RELUME_CLANG} ${RELUME_CLANG_FLAGS} -MD -MT ${RELUME_PTX} -MF ${RELUME_PTX}.d
        ${RELUME_DEVICE_FOLDER}/kernels.cu -o ${RELUME_PTX})
    set(RELUME_COMPRESSED_PTX ${RELUME_PTX}.inc)
    add_custom_command(OUTPUT ${RELUME_COMPRESSED_PTX} DEPENDS ${RELUME_PTX} relume_compress VERBATIM
      COMMAND relume_compress ${RELUME_PTX} ${RELUME_COMPRESSED_PTX})
    add_custom_target(relume_device_code DEPENDS ${RELUME_COMPRESSED_PTX})
  endif()
endif()
