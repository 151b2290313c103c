# Installs relume below WORK, then configures, builds and runs this folder's project with it. Arguments: BUILD (relume's
# build folder), WORK (scratch folder), GENERATOR, BUILD_TYPE, CXX, CXX_FLAGS.
set(prefix ${WORK}/prefix)
file(REMOVE_RECURSE ${WORK})

function(run what)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE result OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT result EQUAL 0)
    message(FATAL_ERROR "${what} failed:\n${output}")
  endif()
endfunction()

run("Installing" ${CMAKE_COMMAND} --install ${BUILD} --prefix ${prefix})
# The project's own compile options and paths must not reach its consumers.
file(GLOB_RECURSE exports ${prefix}/*.cmake)
foreach(file ${exports})
  file(READ ${file} text)
  foreach(leak relume_flags -Wall -march ${BUILD})
    string(FIND "${text}" ${leak} position)
    if(NOT position EQUAL -1)
      message(FATAL_ERROR "${file} mentions ${leak}, which belongs to the build alone")
    endif()
  endforeach()
endforeach()
# The program only shows that the package works.
string(TOUPPER "${BUILD_TYPE}" configuration)
run("Configuring against the package" ${CMAKE_COMMAND} -S ${CMAKE_CURRENT_LIST_DIR} -B ${WORK}/build
  -G ${GENERATOR} -DCMAKE_PREFIX_PATH=${prefix} -DCMAKE_BUILD_TYPE=${BUILD_TYPE} -DCMAKE_CXX_COMPILER=${CXX} -DCMAKE_CXX_FLAGS=${CXX_FLAGS}
  -DCMAKE_CXX_FLAGS_${configuration}=-O0)
run("Building against the package" ${CMAKE_COMMAND} --build ${WORK}/build)
run("The program built against the package" ${CMAKE_COMMAND} -E chdir ${WORK} build/package_test)
