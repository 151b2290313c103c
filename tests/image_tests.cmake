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

# relume_emulate(NAME test...): runs the tests of NAME_tests a second time, with their sessions on the emulated device
# (device/emulated_main.cpp), as the ctests emulated.NAME.*. They carry the label "slow", except the given ones. Those of
# ten thousand frames are left to the host.
function(relume_emulate name)
  if(NOT TARGET relume_emulated_main)
    return()
  endif()
  set(target emulated.${name}_tests)
  add_executable(${target} $<TARGET_OBJECTS:${name}_tests>)
  set_target_properties(${target} PROPERTIES LINKER_LANGUAGE CXX)
  get_target_property(libraries ${name}_tests LINK_LIBRARIES)
  list(REMOVE_ITEM libraries GTest::gtest_main)
  target_link_libraries(${target} PRIVATE ${libraries} relume_emulated_main)
  list(JOIN ARGN : quick)
  gtest_discover_tests(${target} DISCOVERY_TIMEOUT 60 NO_PRETTY_VALUES TEST_PREFIX emulated.${name}.
    TEST_FILTER -*Shared*:*TenThousandFrames*:${quick}
    PROPERTIES TIMEOUT ${RELUME_EMULATED_TEST_TIMEOUT} LABELS slow SKIP_RETURN_CODE 77)
  foreach(test ${ARGN})
    add_test(NAME emulated.${name}.${test} COMMAND ${target} --gtest_filter=${test})
    set_tests_properties(emulated.${name}.${test} PROPERTIES TIMEOUT ${RELUME_TEST_TIMEOUT} COST 20
      FAIL_REGULAR_EXPRESSION "Running 0 tests")
  endforeach()
endfunction()

# relume_emulate_shared(NAME SUITE COUNT): the same for relume_share_processes. Call it after relume_emulate.
function(relume_emulate_shared name suite shards)
  if(TARGET emulated.${name}_tests)
    relume_share_processes(emulated.${name} ${suite} ${shards} TIMEOUT ${RELUME_EMULATED_TEST_TIMEOUT} LABELS slow)
  endif()
endfunction()
