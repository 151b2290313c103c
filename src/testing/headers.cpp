// The headers that all tests begin with are compiled with this file (CMakeLists.txt); the program has no tests of its
// own.
