# install(): programs, the three libraries with their headers, shipped data, and SpinalTapConfig.cmake, so that
# find_package(SpinalTap) gives spinaltap::core, spinaltap::vdb and spinaltap::mesh.
include(CMakePackageConfigHelpers)

install(TARGETS spinaltap_core spinaltap_vdb spinaltap_mesh EXPORT SpinalTapTargets
        ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
foreach(program spinaltap spinaltap-planner)
  if(TARGET ${program})
    install(TARGETS ${program} RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
  endif()
endforeach()
foreach(folder core vdb mesh)
  install(DIRECTORY ${folder} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/spinaltap
          FILES_MATCHING PATTERN "*.h" PATTERN "detail" EXCLUDE PATTERN "*json*.h" EXCLUDE)  # those name nlohmann's types
endforeach()
install(DIRECTORY data/ DESTINATION ${CMAKE_INSTALL_DATADIR}/spinaltap)
install(FILES LICENSE README.md DESTINATION ${CMAKE_INSTALL_DOCDIR})

set(config_dir ${CMAKE_INSTALL_LIBDIR}/cmake/SpinalTap)
install(EXPORT SpinalTapTargets NAMESPACE spinaltap:: DESTINATION ${config_dir})
configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/SpinalTapConfig.cmake.in
                              ${CMAKE_BINARY_DIR}/SpinalTapConfig.cmake INSTALL_DESTINATION ${config_dir})
write_basic_package_version_file(${CMAKE_BINARY_DIR}/SpinalTapConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_BINARY_DIR}/SpinalTapConfig.cmake ${CMAKE_BINARY_DIR}/SpinalTapConfigVersion.cmake
              ${CMAKE_CURRENT_LIST_DIR}/FindNifti2.cmake ${CMAKE_CURRENT_LIST_DIR}/FindHdf5C.cmake
        DESTINATION ${config_dir})
