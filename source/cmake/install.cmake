# cmake --install build --prefix PREFIX: the program, the headers of plug-ins,
# the package that finds them, the Python package, the shipped scenes with their
# meshes, and the examples of plug-ins and scripts.
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

# Where Python of Debian looks for modules without compiled parts: below
# /usr/local in the folder of its version, below /usr in that of all versions,
# which is the place below any other prefix as well (and then has to be named in
# PYTHONPATH). The prefix may still change at installation.
set(NSFD_LOCAL_MODULES lib/python3/dist-packages)
execute_process(
  COMMAND /usr/bin/python3 -c
    "import sys; print('lib/python%d.%d/dist-packages' % sys.version_info[:2])"
  OUTPUT_VARIABLE versioned RESULT_VARIABLE status
  OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
if(status EQUAL 0)
  set(NSFD_LOCAL_MODULES ${versioned})
endif()
install(CODE "
  set(modules lib/python3/dist-packages)
  if(CMAKE_INSTALL_PREFIX STREQUAL \"/usr/local\")
    set(modules ${NSFD_LOCAL_MODULES})
  endif()
  file(INSTALL \"${CMAKE_SOURCE_DIR}/source/python/nsfd\"
       DESTINATION \"\${CMAKE_INSTALL_PREFIX}/\${modules}\"
       FILES_MATCHING PATTERN *.py PATTERN __pycache__ EXCLUDE)
")
