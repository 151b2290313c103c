# relume_find_kernel_lists(FOLDER VARIABLE): sets VARIABLE to the paths of all files kernels.inc in FOLDER, at any depth,
# relative to it.
function(relume_find_kernel_lists folder variable)
  set(depends CONFIGURE_DEPENDS)
  if(CMAKE_SCRIPT_MODE_FILE)
    set(depends "")  # scripts have no later builds
  endif()
  file(GLOB_RECURSE found ${depends} RELATIVE ${folder} ${folder}/kernels.inc)
  set(${variable} "${found}" PARENT_SCOPE)
endfunction()
