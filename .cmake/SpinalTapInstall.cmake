# install(): programs, the libraries with their headers, shipped data, and SpinalTapConfig.cmake, so that
# find_package(SpinalTap) gives spinaltap::spinaltap, and spinaltap::shared, which is the same in one shared library.
include(CMakePackageConfigHelpers)

install(TARGETS spinaltap_core spinaltap_vdb spinaltap_mesh spinaltap_all spinaltap_shared EXPORT SpinalTapTargets
        ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR})
foreach(program spinaltap spinaltap-planner)
  if(TARGET ${program})
    install(TARGETS ${program} RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
  endif()
endforeach()

if(TARGET spinaltap_commands)
  install(TARGETS spinaltap_commands RUNTIME DESTINATION libexec)  # where launcher.cpp looks for it
endif()

install(CODE "set(source \"${PROJECT_SOURCE_DIR}\")\nset(include \"${CMAKE_INSTALL_INCLUDEDIR}\")")
install(SCRIPT ${CMAKE_CURRENT_LIST_DIR}/InstallHeaders.cmake)
install(DIRECTORY data/ DESTINATION ${CMAKE_INSTALL_DATADIR}/spinaltap)
install(FILES LICENSE README.md DESTINATION ${CMAKE_INSTALL_DOCDIR})

set(config_dir ${CMAKE_INSTALL_LIBDIR}/cmake/SpinalTap)
install(EXPORT SpinalTapTargets NAMESPACE spinaltap:: DESTINATION ${config_dir})
set(SPINALTAP_DATA ${CMAKE_INSTALL_DATADIR}/spinaltap)
configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/SpinalTapConfig.cmake.in
                              ${CMAKE_BINARY_DIR}/SpinalTapConfig.cmake INSTALL_DESTINATION ${config_dir}
                              PATH_VARS SPINALTAP_DATA)
write_basic_package_version_file(${CMAKE_BINARY_DIR}/SpinalTapConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_BINARY_DIR}/SpinalTapConfig.cmake ${CMAKE_BINARY_DIR}/SpinalTapConfigVersion.cmake
              ${CMAKE_CURRENT_LIST_DIR}/FindNifti2.cmake ${CMAKE_CURRENT_LIST_DIR}/FindHdf5C.cmake
              ${CMAKE_CURRENT_LIST_DIR}/ImportedLibrary.cmake
        DESTINATION ${config_dir})
