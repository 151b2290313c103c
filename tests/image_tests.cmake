# relume_add_image_tests(NAME source...): tests that render, one ctest each. Those with "Slow" in their name carry the label "slow".
function(relume_add_image_tests name)
  add_executable(${name}_tests ${ARGN})
  target_link_libraries(${name}_tests PRIVATE test_support relume_flags GTest::gtest_main)
  target_precompile_headers(${name}_tests REUSE_FROM relume_test_headers)
  gtest_discover_tests(${name}_tests DISCOVERY_TIMEOUT 60 NO_PRETTY_VALUES TEST_PREFIX ${name}. TEST_FILTER -*Slow* PROPERTIES TIMEOUT ${RELUME_TEST_TIMEOUT})
  gtest_discover_tests(${name}_tests DISCOVERY_TIMEOUT 60 NO_PRETTY_VALUES TEST_PREFIX ${name}. TEST_FILTER *Slow* TEST_LIST ${name}_slow
    PROPERTIES TIMEOUT ${RELUME_SLOW_TEST_TIMEOUT} LABELS slow)
endfunction()
