# relume_add_image_tests(NAME [MOST n] [COST seconds] source... [ALONE pattern...]): adds rendering tests with ctest entries
# for their suites (relume_list_suites), except those with "Shared" in their name. Those with "Slow" in their name carry
# the label "slow". COST (0.5) starts them before unit tests. MOST (8): they take longer than unit tests.
function(relume_add_image_tests name)
  cmake_parse_arguments(arg "" "MOST;COST" ALONE ${ARGN})
  if(NOT DEFINED arg_MOST)
    set(arg_MOST 8)
  endif()
  if(NOT DEFINED arg_COST)
    set(arg_COST 0.5)
  endif()
  add_executable(${name}_tests ${arg_UNPARSED_ARGUMENTS})
  target_link_libraries(${name}_tests PRIVATE test_support relume_testing relume_flags GTest::gtest_main)
  relume_use_test_headers(${name}_tests)
  relume_list_suites(${name}_tests PREFIX ${name}. SLOW *Slow* OMIT *Shared* ALONE ${arg_ALONE} MOST ${arg_MOST} COST ${arg_COST})
endfunction()

# relume_share_processes(NAME SUITES COUNT property...): runs the tests Shared/SUITE or SharedSUITE of NAME_tests in
# COUNT processes with a ctest each. References are rendered once per process. SUITES: one, or a list that shares
# references; the first names the tests.
function(relume_share_processes name suites shards)
  list(GET suites 0 first)
  list(TRANSFORM suites REPLACE "^(.+)$" "Shared/\\1.*:Shared\\1.*")
  list(JOIN suites ":" filter)
  math(EXPR last "${shards} - 1")
  foreach(shard RANGE ${last})
    set(test ${name}.${first}_${shard})
    add_test(NAME ${test} COMMAND ${name}_tests --gtest_filter=${filter})
    # Without this, a program without tests passes.
    set_tests_properties(${test} PROPERTIES ENVIRONMENT "GTEST_TOTAL_SHARDS=${shards};GTEST_SHARD_INDEX=${shard}"
      FAIL_REGULAR_EXPRESSION "Running 0 tests" COST 50 ${ARGN})
  endforeach()
endfunction()

# relume_emulate(NAME test...): runs the tests of NAME_tests a second time, with their sessions on the emulated device
# (device/emulated_main.cpp), as the ctests emulated.NAME.*. They carry the label "slow", except the given ones. Those of
# ten thousand frames and the long sequences of TechniqueDeterminism are left to the host.
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
  # A process each, because a process is skipped if no session ran on the device.
  relume_list_suites(${target} PREFIX emulated.${name}. OMIT *Shared* *TenThousandFrames* SlowAll/TechniqueDeterminism.* ${ARGN} ALONE *
    TIMEOUT ${RELUME_EMULATED_TEST_TIMEOUT} PROPERTIES LABELS slow SKIP_RETURN_CODE 77)
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
