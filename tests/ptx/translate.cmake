# Translates PTX to C++ as a build step. Programs that compile the result link relume_ptx.

# Sets `command` to the translator, `translator` to the files that it consists of, and `options` to those of the compiler
# for its output.
macro(relume_find_translator)
  find_package(Python3 REQUIRED COMPONENTS Interpreter)
  file(GLOB translator CONFIGURE_DEPENDS ${CMAKE_CURRENT_FUNCTION_LIST_DIR}/translator/*.py)
  set(command ${CMAKE_COMMAND} -E env PYTHONDONTWRITEBYTECODE=1 $<TARGET_FILE:Python3::Interpreter>
    ${CMAKE_CURRENT_FUNCTION_LIST_DIR}/translator/translate.py)
  set(options -O1 -w -fno-strict-aliasing)  # memory has no types in PTX
endmacro()

# relume_translate_ptx(FILE.ptx NAME [option...]): translates to NAME.cpp in the build folder, which describes the module in
# ptx::NAME and is compiled with the options.
function(relume_translate_ptx ptx name)
  relume_find_translator()
  add_custom_command(OUTPUT ${name}.cpp DEPENDS ${ptx} ${translator} VERBATIM COMMAND ${command} ${ptx} ${name}.cpp ${name})
  set_source_files_properties(${CMAKE_CURRENT_BINARY_DIR}/${name}.cpp PROPERTIES
    COMPILE_OPTIONS "${options};${ARGN}")
endfunction()

# relume_translate_ptx_in_parts(FILE.ptx NAME COUNT): the same with the functions in COUNT files of similar size. Sets
# NAME_sources.
function(relume_translate_ptx_in_parts ptx name count)
  relume_find_translator()
  set(sources ${name}.cpp)
  math(EXPR last "${count} - 1")
  foreach(part RANGE ${last})
    list(APPEND sources ${name}_${part}.cpp)
  endforeach()
  list(TRANSFORM sources PREPEND ${CMAKE_CURRENT_BINARY_DIR}/)
  add_custom_command(OUTPUT ${sources} ${CMAKE_CURRENT_BINARY_DIR}/${name}.h DEPENDS ${ptx} ${translator} VERBATIM
    COMMAND ${command} ${ptx} ${CMAKE_CURRENT_BINARY_DIR}/${name}.cpp ${name} ${count})
  set_source_files_properties(${sources} PROPERTIES COMPILE_OPTIONS "${options}")
  set(${name}_sources ${sources} PARENT_SCOPE)
endfunction()
