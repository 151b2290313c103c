# cmake --install: the components `library`, with headers and CMake package (find_package(relume) gives relume::relume),
# `shared` (relume::shared), `lab` (relume::lab: metrics, comparisons, experiments) and `program`.
include(CMakePackageConfigHelpers)

set(relume_package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/relume)

install(TARGETS relume EXPORT relumeTargets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT library)
install(EXPORT relumeTargets NAMESPACE relume:: DESTINATION ${relume_package_dir} COMPONENT library)
# A separate component: Debian's development package has only the static library.
install(TARGETS relume_shared EXPORT relumeSharedTargets LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT shared)
install(EXPORT relumeSharedTargets NAMESPACE relume:: DESTINATION ${relume_package_dir} COMPONENT shared)
install(TARGETS relume_lab EXPORT relumeLabTargets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT lab)
install(EXPORT relumeLabTargets NAMESPACE relume:: DESTINATION ${relume_package_dir} COMPONENT lab)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/lab/include/relume DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT lab)

configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/relumeConfig.cmake.in
  ${PROJECT_BINARY_DIR}/relumeConfig.cmake INSTALL_DESTINATION ${relume_package_dir})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/relumeConfigVersion.cmake COMPATIBILITY SameMinorVersion)
# Each of the two libraries can be installed without the other.
foreach(component library shared)
  install(DIRECTORY ${PROJECT_SOURCE_DIR}/include/relume DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT ${component})
  install(FILES ${PROJECT_BINARY_DIR}/relumeConfig.cmake ${PROJECT_BINARY_DIR}/relumeConfigVersion.cmake
    DESTINATION ${relume_package_dir} COMPONENT ${component})
endforeach()
# The package finds the dependencies of the static library with the same list as this build.
install(FILES ${CMAKE_CURRENT_LIST_DIR}/RelumeDependencies.cmake DESTINATION ${relume_package_dir} COMPONENT library)

# Programs are the executables of apps/ and its folders, except tests. The build folder has them in bin/.
function(relume_install_programs folder)
  get_property(targets DIRECTORY ${folder} PROPERTY BUILDSYSTEM_TARGETS)
  foreach(target ${targets})
    get_target_property(type ${target} TYPE)
    if(type STREQUAL EXECUTABLE AND NOT target MATCHES "_(tests|fuzzer)$")
      set_target_properties(${target} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/bin)
      install(TARGETS ${target} RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT program)
    endif()
  endforeach()
  get_property(folders DIRECTORY ${folder} PROPERTY SUBDIRECTORIES)
  foreach(subfolder ${folders})
    relume_install_programs(${subfolder})
  endforeach()
endfunction()
relume_install_programs(${PROJECT_SOURCE_DIR}/apps)

set(desktop_dir ${PROJECT_SOURCE_DIR}/apps/relume/desktop)
install(FILES ${desktop_dir}/relume.xml DESTINATION ${CMAKE_INSTALL_DATADIR}/mime/packages COMPONENT program)
if(RELUME_HAS_VIEWER)
  install(FILES ${desktop_dir}/relume.desktop DESTINATION ${CMAKE_INSTALL_DATADIR}/applications COMPONENT program)
  install(FILES ${desktop_dir}/relume.svg DESTINATION ${CMAKE_INSTALL_DATADIR}/icons/hicolor/scalable/apps COMPONENT program)
endif()

# Debian's packages have a separate licence file.
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/relume COMPONENT license)
