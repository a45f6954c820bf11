# Finds the HDF5 library for C and makes the target hdf5::hdf5. CMake's own FindHDF5 compiles a C program, and this
# project has no C compiler.
include(${CMAKE_CURRENT_LIST_DIR}/ImportedLibrary.cmake)
find_imported_library(Hdf5C hdf5::hdf5 hdf5.h hdf5/serial hdf5_serial hdf5)
