# Installs and exports the libraries, so that find_package(calomel) works.
include(CMakePackageConfigHelpers)
get_property(libraries GLOBAL PROPERTY CALOMEL_LIBRARIES)
install(TARGETS ${libraries} EXPORT calomelTargets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(TARGETS calomel RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
install(TARGETS reference_generator RUNTIME DESTINATION ${CMAKE_INSTALL_LIBEXECDIR}/calomel)  # where `calomel challenge make` looks for it
foreach(folder base forward inverse uq)
  install(DIRECTORY ${PROJECT_SOURCE_DIR}/${folder} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/calomel
    FILES_MATCHING PATTERN "*.hpp")
endforeach()
install(EXPORT calomelTargets NAMESPACE calomel:: DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/calomel)
configure_package_config_file(${PROJECT_SOURCE_DIR}/cmake/calomelConfig.cmake.in
  ${PROJECT_BINARY_DIR}/calomelConfig.cmake INSTALL_DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/calomel)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/calomelConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/calomelConfig.cmake ${PROJECT_BINARY_DIR}/calomelConfigVersion.cmake
  DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/calomel)
