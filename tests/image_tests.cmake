# relume_add_image_tests(NAME source...): adds rendering tests with a ctest each, except those with "Shared" in their
# name. Those with "Slow" in their name carry the label "slow". COST starts them before unit tests, so that short
# tests fill the cores at the end.
function(relume_add_image_tests name)
  add_executable(${name}_tests ${ARGN})
  target_link_libraries(${name}_tests PRIVATE test_support relume_testing relume_flags GTest::gtest_main)
  relume_use_test_headers(${name}_tests)
  gtest_discover_tests(${name}_tests DISCOVERY_TIMEOUT 60 NO_PRETTY_VALUES TEST_PREFIX ${name}. TEST_FILTER -*Slow*:*Shared*
    PROPERTIES TIMEOUT ${RELUME_TEST_TIMEOUT} COST 5)
  gtest_discover_tests(${name}_tests DISCOVERY_TIMEOUT 60 NO_PRETTY_VALUES TEST_PREFIX ${name}. TEST_FILTER *Slow*-*Shared* TEST_LIST ${name}_slow
    PROPERTIES TIMEOUT ${RELUME_SLOW_TEST_TIMEOUT} LABELS slow)
endfunction()

# relume_share_processes(NAME SUITE COUNT property...): runs the tests Shared/SUITE or SharedSUITE of NAME_tests in
# COUNT processes with a ctest each. References are rendered once per process.
function(relume_share_processes name suite shards)
  math(EXPR last "${shards} - 1")
  foreach(shard RANGE ${last})
    set(test ${name}.${suite}_${shard})
    add_test(NAME ${test} COMMAND ${name}_tests --gtest_filter=Shared/${suite}.*:Shared${suite}.*)
    # Without this, a program without tests passes.
    set_tests_properties(${test} PROPERTIES ENVIRONMENT "GTEST_TOTAL_SHARDS=${shards};GTEST_SHARD_INDEX=${shard}"
      FAIL_REGULAR_EXPRESSION "Running 0 tests" COST 50 ${ARGN})
  endforeach()
endfunction()
