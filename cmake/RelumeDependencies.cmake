# Libraries of relume, all from packages of Debian 12 and 13 (listed in scripts/install_packages). The installed CMake
# package finds the same ones.
find_package(Threads REQUIRED)
# src/accel/embree/embree.h prefers version 4 if both are installed.
find_package(embree 4 QUIET)
if(NOT embree_FOUND)
  find_package(embree 3.13 REQUIRED)
endif()
find_package(TBB REQUIRED)
# Debian's CMake package of Imath requires its Python modules; pkg-config does not.
find_package(PkgConfig REQUIRED)
pkg_check_modules(OPENEXR REQUIRED IMPORTED_TARGET OpenEXR>=3.1)
pkg_check_modules(WEBP REQUIRED IMPORTED_TARGET libwebp)
pkg_check_modules(ZSTD REQUIRED IMPORTED_TARGET libzstd)
pkg_check_modules(ZLIB REQUIRED IMPORTED_TARGET zlib)
find_package(assimp REQUIRED)
find_package(draco REQUIRED)
find_package(meshoptimizer REQUIRED)
find_package(TinyGLTF REQUIRED)
find_package(nlohmann_json REQUIRED)
find_package(pugixml REQUIRED)
find_package(fmt REQUIRED)
find_path(GLM_INCLUDE_DIR glm/vec3.hpp REQUIRED)
find_path(STB_INCLUDE_DIR stb_image.h PATH_SUFFIXES stb REQUIRED)
find_library(STB_LIBRARY stb REQUIRED)
# Optional: `--ocio` reports if it is missing. Debian 12 installs its CMake package outside CMake's search path.
pkg_check_modules(OCIO QUIET IMPORTED_TARGET OpenColorIO>=2.0)
# Not in Debian 12: the denoiser `oidn` reports if it is missing.
find_package(OpenImageDenoise QUIET)
