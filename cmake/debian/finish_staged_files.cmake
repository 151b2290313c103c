# CPack runs this between staging and packing: applies rules of Debian's policy beyond `cmake --install`. Time stamps in
# the packages are the version's date, so that equal files make equal packages.
if(CPACK_RELUME_WITH_OIDN)
  message(FATAL_ERROR "The build uses OpenImageDenoise, of which Debian has no package to depend on. "
    "Configure it with -DCMAKE_DISABLE_FIND_PACKAGE_OpenImageDenoise=ON.")
endif()

set(stage ${CPACK_TEMPORARY_DIRECTORY})
set(package_of_program relume)
set(package_of_library librelume-dev)
set(package_of_python python3-relume)
set(package_of_mpi_openmpi relume-mpi-openmpi)
set(package_of_mpi_mpich relume-mpi-mpich)
set(components program library)
foreach(component python mpi_openmpi mpi_mpich)
  if(IS_DIRECTORY ${stage}/${component})
    list(APPEND components ${component})
  endif()
endforeach()
list(TRANSFORM components PREPEND ${stage}/ OUTPUT_VARIABLE folders)

function(run)
  execute_process(COMMAND ${ARGN} COMMAND_ERROR_IS_FATAL ANY)
endfunction()

execute_process(COMMAND date -u -R -d ${CPACK_RELUME_VERSION_DATE} OUTPUT_VARIABLE date OUTPUT_STRIP_TRAILING_WHITESPACE
  COMMAND_ERROR_IS_FATAL ANY)

foreach(component ${components})
  set(documents ${stage}/${component}/usr/share/doc/${package_of_${component}})
  file(MAKE_DIRECTORY ${documents})
  file(COPY ${CMAKE_CURRENT_LIST_DIR}/copyright DESTINATION ${documents}
    FILE_PERMISSIONS OWNER_READ OWNER_WRITE GROUP_READ WORLD_READ)
  file(WRITE ${documents}/changelog
    "relume (${CPACK_PACKAGE_VERSION}) unstable; urgency=medium\n\n  * Version ${CPACK_PACKAGE_VERSION}.\n\n"
    " -- ${CPACK_PACKAGE_CONTACT}  ${date}\n")
  file(GLOB_RECURSE pages ${stage}/${component}/usr/share/man/*.1)
  run(gzip -9n ${documents}/changelog ${pages})
endforeach()

# CPack strips programs, but keeps sections that only name the compiler; archives keep their symbols for linking.
set(sections --remove-section=.comment --remove-section=.note --enable-deterministic-archives)
file(GLOB programs ${stage}/program/usr/bin/* ${stage}/python/usr/lib/python3/dist-packages/relume/*.so
  ${stage}/mpi_openmpi/usr/lib/relume/*.so ${stage}/mpi_mpich/usr/lib/relume/*.so)
run(${CPACK_RELUME_STRIP} ${sections} ${programs})
file(GLOB_RECURSE archives ${stage}/library/*.a)
run(${CPACK_RELUME_STRIP} --strip-debug ${sections} ${archives})

run(find ${folders} -type d -empty -delete)
run(chmod -R u=rwX,go=rX ${folders})
run(find ${folders} -exec touch -h -d ${CPACK_RELUME_VERSION_DATE}T00:00:00Z {} +)
