// Builds the precompiled headers of all tests (CMakeLists.txt). The program contains no tests.
