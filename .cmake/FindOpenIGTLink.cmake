# Finds OpenIGTLink and makes the target OpenIGTLink::igtl. Debian 12's own OpenIGTLinkConfig.cmake stops at every CMake but
# the one that it was made with.
include(${CMAKE_CURRENT_LIST_DIR}/ImportedLibrary.cmake)
find_imported_library(OpenIGTLink OpenIGTLink::igtl igtl_header.h openigtlink OpenIGTLink)
