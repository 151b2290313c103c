# Build options and compiler flags.
option(RELUME_BUILD_TESTS "Build the tests" ON)
option(RELUME_BUILD_BENCHMARKS "Build the benchmarks" ON)
option(RELUME_BUILD_PYTHON "Build the Python package, if pybind11 is installed" ON)
option(RELUME_MPI "Build the plugins for renders on several machines, for Open MPI and MPICH where they are installed" ON)
set(RELUME_PYTHON_DIR "lib/python3/dist-packages" CACHE STRING "Folder of Python packages below the installation prefix")
option(RELUME_WARNINGS_AS_ERRORS "Treat compiler warnings as errors" OFF)
option(RELUME_STANDARD_MATH "Compute elementary functions with the C++ library, for tools/compare_math" OFF)
option(RELUME_FUZZERS "Build the libFuzzer targets (needs Clang)" OFF)
set(RELUME_SANITIZE "" CACHE STRING "Sanitizers of the build: empty, address;undefined or thread")
if(CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
  set(RELUME_ARCH "x86-64-v3" CACHE STRING "-march of the build: x86-64-v3 (AVX2), x86-64 (any), native")
elseif(CMAKE_SYSTEM_PROCESSOR MATCHES "aarch64|arm64")
  set(RELUME_ARCH "armv8-a" CACHE STRING "-march of the build: armv8-a (any), native")
else()
  set(RELUME_ARCH "" CACHE STRING "-march of the build; empty: the compiler's default")
endif()

set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)

if(NOT CMAKE_BUILD_TYPE AND NOT CMAKE_CONFIGURATION_TYPES)
  set(CMAKE_BUILD_TYPE Release CACHE STRING "Build type" FORCE)
endif()

find_program(CCACHE_PROGRAM ccache)
if(CCACHE_PROGRAM)
  # Sloppiness: without it, ccache does not cache sources with precompiled headers. Depend mode: ccache compares the text of
  # headers, comments included, as GCC does for `#pragma once` in a precompiled header. Otherwise a changed comment brings
  # back the old precompiled header, with which nothing compiles. Namespace: apart from entries made without depend mode.
  set(CMAKE_CXX_COMPILER_LAUNCHER
    ${CMAKE_COMMAND} -E env CCACHE_SLOPPINESS=pch_defines,time_macros CCACHE_DEPEND=1 CCACHE_NAMESPACE=relume
    ${CCACHE_PROGRAM})
endif()

# relume_not_hot(TARGET...): compiles targets without hot code with -Og. This takes a third less CPU time than -O3 and a
# fifth less than -O2 (medians over six sources, GCC 12). GCC 14 rejects precompiled headers of another optimisation
# level, so tests use those of relume_test_headers_not_hot. With -Og, GCC wrongly reports that variables are not
# initialised, such as a std::stop_source.
function(relume_not_hot)
  foreach(target ${ARGN})
    target_compile_options(${target} PRIVATE
      $<$<CONFIG:Release>:-Og> $<$<AND:$<CONFIG:Release>,$<CXX_COMPILER_ID:GNU>>:-Wno-maybe-uninitialized>)
    get_target_property(headers ${target} PRECOMPILE_HEADERS_REUSE_FROM)
    if(headers STREQUAL relume_test_headers)
      set_target_properties(${target} PROPERTIES PRECOMPILE_HEADERS_REUSE_FROM relume_test_headers_not_hot)
    endif()
  endforeach()
endfunction()

# Common headers, precompiled once per target. The preset `ci` disables them (CMAKE_DISABLE_PRECOMPILE_HEADERS) except
# in tests, so that each file must include what it uses.
set(RELUME_PRECOMPILED
  <algorithm> <chrono> <cmath> <cstdint> <filesystem> <functional> <map> <memory> <optional> <span> <stop_token> <string>
  <string_view> <vector> <relume/error.h> <core/vec.h>)

# Compiler options of all targets.
add_library(relume_flags INTERFACE)
target_compile_options(relume_flags INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor -Woverloaded-virtual
  # Equal bits at any optimisation level: no fused multiply-add, no reassociation.
  -ffp-contract=off
  -fno-math-errno -fno-trapping-math)
if(RELUME_ARCH)
  target_compile_options(relume_flags INTERFACE -march=${RELUME_ARCH})
endif()
if(RELUME_STANDARD_MATH)
  target_compile_definitions(relume_flags INTERFACE RELUME_STANDARD_MATH)
endif()
if(RELUME_WARNINGS_AS_ERRORS)
  target_compile_options(relume_flags INTERFACE -Werror)
endif()
if(RELUME_SANITIZE)
  list(TRANSFORM RELUME_SANITIZE PREPEND -fsanitize= OUTPUT_VARIABLE sanitizers)
  list(APPEND sanitizers -fno-sanitize-recover=undefined -fno-omit-frame-pointer)
  target_compile_options(relume_flags INTERFACE ${sanitizers})
  target_link_options(relume_flags INTERFACE ${sanitizers})
endif()
if(RELUME_FUZZERS)
  # Coverage for libFuzzer in all of relume; the targets of tests/fuzz link its main function.
  target_compile_options(relume_flags INTERFACE -fsanitize=fuzzer-no-link)
  target_link_options(relume_flags INTERFACE -fsanitize=fuzzer-no-link)
endif()
