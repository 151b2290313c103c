# cmake --install: the library with its headers and its CMake package (find_package(relume) gives relume::relume) and the
# program.
include(CMakePackageConfigHelpers)

set(relume_package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/relume)

install(TARGETS relume EXPORT relumeTargets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(EXPORT relumeTargets NAMESPACE relume:: DESTINATION ${relume_package_dir})
install(DIRECTORY ${PROJECT_SOURCE_DIR}/src/ DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/relume
  FILES_MATCHING PATTERN "*.h" PATTERN "testing" EXCLUDE)

configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/relumeConfig.cmake.in
  ${PROJECT_BINARY_DIR}/relumeConfig.cmake INSTALL_DESTINATION ${relume_package_dir})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/relumeConfigVersion.cmake COMPATIBILITY SameMinorVersion)
# The package looks for its dependencies with the very list that this build used.
install(FILES
  ${PROJECT_BINARY_DIR}/relumeConfig.cmake
  ${PROJECT_BINARY_DIR}/relumeConfigVersion.cmake
  ${CMAKE_CURRENT_LIST_DIR}/RelumeDependencies.cmake
  DESTINATION ${relume_package_dir})

# The programs are the executables of apps/ and its folders, but for tests. In the build folder they stand in bin/.
function(relume_install_programs folder)
  get_property(targets DIRECTORY ${folder} PROPERTY BUILDSYSTEM_TARGETS)
  foreach(target ${targets})
    get_target_property(type ${target} TYPE)
    if(type STREQUAL EXECUTABLE AND NOT target MATCHES "_(tests|fuzzer)$")
      set_target_properties(${target} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/bin)
      install(TARGETS ${target} RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
    endif()
  endforeach()
  get_property(folders DIRECTORY ${folder} PROPERTY SUBDIRECTORIES)
  foreach(subfolder ${folders})
    relume_install_programs(${subfolder})
  endforeach()
endfunction()
relume_install_programs(${PROJECT_SOURCE_DIR}/apps)

install(FILES ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/relume)
