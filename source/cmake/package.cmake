# The manual page and the completion of the shell, and `cpack`: a Debian package
# of what is installed. What the program is linked with becomes its dependencies.
install(CODE "
  execute_process(
    COMMAND sh ${CMAKE_SOURCE_DIR}/source/package/manual_page.sh $<TARGET_FILE:nsfd>
    OUTPUT_FILE ${CMAKE_BINARY_DIR}/nsfd.1 RESULT_VARIABLE status)
  if(NOT status EQUAL 0)
    message(FATAL_ERROR \"the manual page could not be made\")
  endif()
")
install(FILES ${CMAKE_BINARY_DIR}/nsfd.1 TYPE MAN RENAME man1/nsfd.1)
install(FILES source/package/completion.bash
        DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions
        RENAME nsfd)

# what is built is packed: the tests are no part of it
set(CMAKE_SKIP_INSTALL_ALL_DEPENDENCY ON)
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME nsfd)
set(CPACK_PACKAGE_CONTACT "the authors of nsfd <nsfd@localhost>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "nonsmooth fracture dynamics")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
# mpirun; what the Python package imports
set(CPACK_DEBIAN_PACKAGE_DEPENDS openmpi-bin)
set(CPACK_DEBIAN_PACKAGE_RECOMMENDS "python3-numpy, python3-h5py")
set(CPACK_DEBIAN_PACKAGE_SUGGESTS
    "paraview, gmsh, bash-completion, python3-matplotlib, python3-pandas")
set(CPACK_DEBIAN_PACKAGE_DESCRIPTION
"Dynamic fracture as a nonsmooth mechanical system: every cell is a body,
faces carry cohesion, unilateral contact and Coulomb friction.")
include(CPack)
