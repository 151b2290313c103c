if(RELUME_BUILD_TESTS)
  enable_testing()
  find_package(GTest REQUIRED)
  # Not find_package(Python3), which would keep python/ from choosing an interpreter with numpy.
  find_program(RELUME_TEST_PYTHON python3 REQUIRED DOC "Interpreter of cmake/list_suites.py")
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

# relume_list_suites(TARGET PREFIX text [SLOW pattern...] [OMIT pattern...] [ALONE pattern...] [MOST n] [COST seconds]
# [TIMEOUT seconds] [PROPERTIES name value...]): adds the ctest entries of a GoogleTest program. The tests of a suite share
# entries of at most about MOST tests (64). Slow tests have an entry each, and so have those of ALONE suites, which change
# or measure state of their process. COST: estimated seconds of a test; ctest starts long entries first, so that short ones
# fill the cores at the end. TIMEOUT: of one test; further tests of an entry add a sixtieth each.
set(RELUME_LIST_SUITES ${CMAKE_CURRENT_LIST_DIR}/list_suites.py)
function(relume_list_suites target)
  cmake_parse_arguments(arg "" "PREFIX;MOST;COST;TIMEOUT" "SLOW;OMIT;ALONE;PROPERTIES" ${ARGN})
  if(NOT DEFINED arg_MOST)
    set(arg_MOST 64)
  endif()
  if(NOT DEFINED arg_COST)
    set(arg_COST 0.05)
  endif()
  if(NOT DEFINED arg_TIMEOUT)
    set(arg_TIMEOUT ${RELUME_TEST_TIMEOUT})
  endif()
  set(entries ${CMAKE_CURRENT_BINARY_DIR}/${target}_entries.cmake)
  set(included ${CMAKE_CURRENT_BINARY_DIR}/${target}_included.cmake)
  get_target_property(emulator ${target} CROSSCOMPILING_EMULATOR)
  if(NOT emulator)
    set(emulator "")
  endif()
  set_property(TARGET ${target} APPEND PROPERTY LINK_DEPENDS ${RELUME_LIST_SUITES})
  add_custom_command(TARGET ${target} POST_BUILD BYPRODUCTS ${entries} VERBATIM
    COMMAND ${RELUME_TEST_PYTHON} ${RELUME_LIST_SUITES} $<TARGET_FILE:${target}> ${entries}
      --prefix ${arg_PREFIX} --directory ${CMAKE_CURRENT_BINARY_DIR} --most ${arg_MOST} --cost ${arg_COST}
      --timeout ${arg_TIMEOUT} --slow-timeout ${RELUME_SLOW_TEST_TIMEOUT} "--slow=${arg_SLOW}" "--omit=${arg_OMIT}"
      "--alone=${arg_ALONE}" "--emulator=${emulator}" "--properties=${arg_PROPERTIES}")
  file(WRITE ${included} "if(EXISTS \"${entries}\")
  include(\"${entries}\")
else()
  add_test(${target}_not_built ${target}_not_built)
endif()
")
  set_property(DIRECTORY APPEND PROPERTY TEST_INCLUDE_FILES ${included})
endfunction()

# relume_add_tests(NAME [COST seconds] source... [ALONE pattern...]): builds a GoogleTest program from the *_test.cpp files
# of a folder, with ctest entries for its suites (relume_list_suites). Suites whose name begins with "Slow" carry the
# label "slow".
function(relume_add_tests name)
  if(NOT RELUME_BUILD_TESTS)
    return()
  endif()
  cmake_parse_arguments(arg "" COST ALONE ${ARGN})
  if(NOT DEFINED arg_COST)
    set(arg_COST 0.05)
  endif()
  add_executable(${name}_tests ${arg_UNPARSED_ARGUMENTS})
  target_link_libraries(${name}_tests PRIVATE relume_lab relume relume_testing relume_flags GTest::gtest_main)
  relume_use_test_headers(${name}_tests)
  relume_list_suites(${name}_tests PREFIX ${name}. SLOW Slow* ALONE ${arg_ALONE} COST ${arg_COST})
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
