# cpack: the Debian packages `relume`, the program with its data, `librelume-dev`, the static library with its headers, and
# `python3-relume`, if it is built.
# Debian's standard environment variables set the maintainer.
set(RELUME_MAINTAINER "relume maintainers <maintainers@relume.invalid>" CACHE STRING "Maintainer of the Debian packages")
if(DEFINED ENV{DEBFULLNAME} AND DEFINED ENV{DEBEMAIL})
  set(RELUME_MAINTAINER "$ENV{DEBFULLNAME} <$ENV{DEBEMAIL}>")
endif()

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME relume)
# Each package has its own summary, to which CPack would prepend this one.
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "")
set(CPACK_PACKAGE_VERSION ${PROJECT_VERSION})
set(CPACK_PACKAGE_CONTACT ${RELUME_MAINTAINER})
set(CPACK_STRIP_FILES ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS
  OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
set(CPACK_COMPONENTS_ALL program library)
set(CPACK_COMPONENTS_GROUPING IGNORE)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_ENABLE_COMPONENT_DEPENDS OFF)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_PRE_BUILD_SCRIPTS ${CMAKE_CURRENT_LIST_DIR}/debian/finish_staged_files.cmake)
set(CPACK_RELUME_VERSION_DATE ${RELUME_VERSION_DATE})
set(CPACK_RELUME_STRIP ${CMAKE_STRIP})
set(CPACK_RELUME_WITH_OIDN ${OpenImageDenoise_FOUND})

# Debian does not require AVX2. Without it, a program of these levels ends with an illegal instruction. The description
# therefore states the requirement, and preinst stops the installation.
set(processor_note "")
if(RELUME_ARCH STREQUAL "native")
  set(processor_note "\n\nThis build is for the processor of the machine that built it.")
elseif(RELUME_ARCH MATCHES "^x86-64-v[3-9]$")
  set(processor_note "\n\nThis build needs a processor with AVX2 (${RELUME_ARCH}).")
  set(CPACK_DEBIAN_PROGRAM_PACKAGE_CONTROL_EXTRA ${CMAKE_CURRENT_LIST_DIR}/debian/preinst)
endif()

# CPack would use the architecture of the build machine.
if(CMAKE_CROSSCOMPILING)
  set(CPACK_DEBIAN_PACKAGE_ARCHITECTURE ${CMAKE_SYSTEM_PROCESSOR})
  if(CMAKE_SYSTEM_PROCESSOR STREQUAL "aarch64")
    set(CPACK_DEBIAN_PACKAGE_ARCHITECTURE arm64)
  elseif(CMAKE_SYSTEM_PROCESSOR STREQUAL "x86_64")
    set(CPACK_DEBIAN_PACKAGE_ARCHITECTURE amd64)
  endif()
endif()

set(CPACK_DEBIAN_PROGRAM_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_NAME relume)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SECTION graphics)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SUGGESTS "ffmpeg")  # videos
set(CPACK_DEBIAN_PROGRAM_DESCRIPTION "path tracer that reuses samples across frames
relume renders glTF scenes by path tracing: to images and animations, or in a
window in which camera, lights, materials and settings change while the scene
is rendered.

It is unbiased and deterministic, and runs on the processor. Techniques that
reuse samples across pixels, frames and paths can be combined and compared.${processor_note}")

set(CPACK_DEBIAN_LIBRARY_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_LIBRARY_PACKAGE_NAME librelume-dev)
set(CPACK_DEBIAN_LIBRARY_PACKAGE_SECTION libdevel)
# Dependencies of the CMake package (RelumeDependencies.cmake).
set(CPACK_DEBIAN_LIBRARY_PACKAGE_DEPENDS
  "libassimp-dev, libcli11-dev, libdraco-dev, libembree-dev, libfmt-dev, libglm-dev, libmeshoptimizer-dev, libopenexr-dev, \
libpugixml-dev, libstb-dev, libtbb-dev, libtinygltf-dev, libwebp-dev, libzstd-dev, nlohmann-json3-dev, pkgconf, \
zlib1g-dev")
if(OCIO_FOUND)
  string(APPEND CPACK_DEBIAN_LIBRARY_PACKAGE_DEPENDS ", libopencolorio-dev")
endif()
set(CPACK_DEBIAN_LIBRARY_DESCRIPTION "path tracer that reuses samples across frames (development files)
relume renders glTF scenes by path tracing. Techniques that reuse samples
across pixels, frames and paths can be combined and compared.

This package contains the static library, its headers and its CMake package.${processor_note}")

foreach(library OPENMPI MPICH)
  string(TOLOWER ${library} name)
  if(TARGET relume-mpi-${name})
    list(APPEND CPACK_COMPONENTS_ALL mpi_${name})
    set(CPACK_DEBIAN_MPI_${library}_FILE_NAME DEB-DEFAULT)
    set(CPACK_DEBIAN_MPI_${library}_PACKAGE_NAME relume-mpi-${name})
    set(CPACK_DEBIAN_MPI_${library}_PACKAGE_SECTION graphics)
    set(CPACK_DEBIAN_MPI_${library}_PACKAGE_SHLIBDEPS ON)
    set(CPACK_DEBIAN_MPI_${library}_PACKAGE_DEPENDS "relume (= ${PROJECT_VERSION})")
    set(CPACK_DEBIAN_MPI_${library}_DESCRIPTION "path tracer that reuses samples across frames (plugin for ${name})
relume renders glTF scenes by path tracing. Techniques that reuse samples
across pixels, frames and paths can be combined and compared.

With this package, the ranks of mpirun share one render.${processor_note}")
  endif()
endforeach()

if(RELUME_HAS_PYTHON)
  list(APPEND CPACK_COMPONENTS_ALL python)
  set(CPACK_DEBIAN_PYTHON_FILE_NAME DEB-DEFAULT)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-relume)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_SHLIBDEPS ON)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS
    "python3 (>= ${RELUME_PYTHON_VERSION}), python3 (<< ${RELUME_NEXT_PYTHON_VERSION}), python3-numpy")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_SUGGESTS "python3-ipywidgets, python3-pandas, python3-tqdm")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_CONTROL_EXTRA
    "${CMAKE_CURRENT_LIST_DIR}/debian/python/postinst;${CMAKE_CURRENT_LIST_DIR}/debian/python/prerm")
  if(CPACK_DEBIAN_PROGRAM_PACKAGE_CONTROL_EXTRA)
    list(APPEND CPACK_DEBIAN_PYTHON_PACKAGE_CONTROL_EXTRA ${CPACK_DEBIAN_PROGRAM_PACKAGE_CONTROL_EXTRA})
  endif()
  set(CPACK_DEBIAN_PYTHON_DESCRIPTION "path tracer that reuses samples across frames (Python 3)
relume renders glTF scenes by path tracing. Techniques that reuse samples
across pixels, frames and paths can be combined and compared.

This package contains the Python module: scenes from files or NumPy arrays,
images, the state of techniques, and comparisons.${processor_note}")
endif()

include(CPack)
