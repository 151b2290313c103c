if(RELUME_BUILD_TESTS)
  enable_testing()
  find_package(GTest REQUIRED)
  include(GoogleTest)
endif()

# Time limit of a test in seconds. Sanitizers take about ten times longer, and so may the emulated device.
set(RELUME_TEST_TIMEOUT 900)
set(RELUME_SLOW_TEST_TIMEOUT 2400)
set(RELUME_EMULATED_TEST_TIMEOUT 14400)
if(RELUME_SANITIZE)
  set(RELUME_TEST_TIMEOUT 6000)
  set(RELUME_SLOW_TEST_TIMEOUT 20000)
endif()

# relume_skip_test(NAME REASON): adds a test that ctest reports as skipped on this machine.
function(relume_skip_test name reason)
  message(STATUS "${reason}: the test ${name} will be skipped")
  add_test(NAME ${name} COMMAND sh -c "echo '${reason}' && exit 77")
  set_tests_properties(${name} PROPERTIES SKIP_RETURN_CODE 77)
endfunction()

# relume_optimise_tests(TARGET): compiles tests, and their precompiled headers, with -O2 instead of -O3. Kernels in tests
# run briefly, and their bits do not depend on it. relume_not_hot() overrides it.
function(relume_optimise_tests target)
  target_compile_options(${target} PRIVATE $<$<CONFIG:Release>:-O2>)
endfunction()

# relume_use_test_headers(TARGET): uses the precompiled headers of tests in every preset, which take a third of a test's
# compilation.
function(relume_use_test_headers target)
  relume_optimise_tests(${target})
  set_target_properties(${target} PROPERTIES DISABLE_PRECOMPILE_HEADERS OFF)
  target_precompile_headers(${target} REUSE_FROM relume_test_headers)
endfunction()

# relume_add_tests(NAME [COST n] source...): builds a GoogleTest program from the *_test.cpp files of a folder, with a
# ctest per test. Suites whose name begins with "Slow" carry the label "slow". ctest starts tests of a higher COST first
# (default: 0), so that short ones fill the cores at the end.
function(relume_add_tests name)
  if(NOT RELUME_BUILD_TESTS)
    return()
  endif()
  cmake_parse_arguments(arg "" COST "" ${ARGN})
  if(NOT DEFINED arg_COST)
    set(arg_COST 0)
  endif()
  add_executable(${name}_tests ${arg_UNPARSED_ARGUMENTS})
  target_link_libraries(${name}_tests PRIVATE relume_lab relume relume_testing relume_flags GTest::gtest_main)
  relume_use_test_headers(${name}_tests)
  gtest_discover_tests(${name}_tests DISCOVERY_TIMEOUT 60 NO_PRETTY_VALUES TEST_PREFIX ${name}. TEST_FILTER -Slow*
    PROPERTIES TIMEOUT ${RELUME_TEST_TIMEOUT} COST ${arg_COST})
  gtest_discover_tests(${name}_tests DISCOVERY_TIMEOUT 60 NO_PRETTY_VALUES TEST_PREFIX ${name}. TEST_FILTER Slow* TEST_LIST ${name}_slow
    PROPERTIES TIMEOUT ${RELUME_SLOW_TEST_TIMEOUT} LABELS slow)
endfunction()

# relume_not_hot_tests(NAME...): compiles test programs with -Og (relume_not_hot). For tests that leave the computing to
# the library: the linker would take their copies of a kernel's inline functions for the library's kernels, too.
function(relume_not_hot_tests)
  if(RELUME_BUILD_TESTS)
    list(TRANSFORM ARGN APPEND _tests OUTPUT_VARIABLE targets)
    relume_not_hot(${targets})
  endif()
endfunction()

# relume_add_benchmarks(source...): adds *_bench.cpp files to the program `relume_bench`.
function(relume_add_benchmarks)
  foreach(source ${ARGN})
    set_property(GLOBAL APPEND PROPERTY RELUME_BENCH_SOURCES ${CMAKE_CURRENT_SOURCE_DIR}/${source})
  endforeach()
endfunction()
