# cmake --install build --prefix PREFIX: the program, the headers of plug-ins,
# the package that finds them, the shipped scenes with their meshes, and the
# examples of plug-ins.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

# libraries that are not where the system looks for them
set_target_properties(nsfd PROPERTIES INSTALL_RPATH_USE_LINK_PATH ON)
install(TARGETS nsfd RUNTIME)
install(DIRECTORY ${CMAKE_SOURCE_DIR}/include/nsfd
                  ${CMAKE_BINARY_DIR}/include/nsfd
        TYPE INCLUDE FILES_MATCHING PATTERN *.h)
install(DIRECTORY ${CMAKE_SOURCE_DIR}/prm ${CMAKE_SOURCE_DIR}/doc/examples
        DESTINATION ${CMAKE_INSTALL_DATADIR}/nsfd)
# the documents link to each other by their places in the checkout
install(FILES README.md CONTRIBUTING.md LICENSE CITATION.cff CHANGELOG.md TYPE DOC)
install(DIRECTORY ${CMAKE_SOURCE_DIR}/doc TYPE DOC)

set(package ${CMAKE_INSTALL_LIBDIR}/cmake/nsfd)
configure_package_config_file(
  ${CMAKE_CURRENT_LIST_DIR}/nsfdConfig.cmake.in
  ${CMAKE_BINARY_DIR}/package/nsfdConfig.cmake
  INSTALL_DESTINATION ${package}
  PATH_VARS CMAKE_INSTALL_INCLUDEDIR CMAKE_INSTALL_BINDIR
            CMAKE_INSTALL_DATADIR)
# before 1.0 each minor version may change everything
write_basic_package_version_file(
  ${CMAKE_BINARY_DIR}/package/nsfdConfigVersion.cmake
  COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_BINARY_DIR}/package/nsfdConfig.cmake
              ${CMAKE_BINARY_DIR}/package/nsfdConfigVersion.cmake
              ${CMAKE_CURRENT_LIST_DIR}/nsfd_add_plug_in.cmake
              ${CMAKE_CURRENT_LIST_DIR}/plug_in.cc.in
              ${CMAKE_CURRENT_LIST_DIR}/plug_in.map
        DESTINATION ${package})
