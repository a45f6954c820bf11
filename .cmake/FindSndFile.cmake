# Finds libsndfile and makes the target SndFile::sndfile. Debian 12's package has no CMake file of its own.
include(${CMAKE_CURRENT_LIST_DIR}/ImportedLibrary.cmake)
find_imported_library(SndFile SndFile::sndfile sndfile.h "" sndfile)
