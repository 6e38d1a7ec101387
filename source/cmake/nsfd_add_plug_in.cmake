set(nsfd_PACKAGE ${CMAKE_CURRENT_LIST_DIR})

# nsfd_add_plug_in(NAME FILE.cc ...): the library NAME.so in the build folder,
# a target NAME. Further libraries: target_link_libraries(NAME PRIVATE ...).
function(nsfd_add_plug_in name)
  # what it was built against, for the program to look at before it loads it
  configure_file(${nsfd_PACKAGE}/plug_in.cc.in
                 ${CMAKE_CURRENT_BINARY_DIR}/${name}_plug_in.cc @ONLY)
  add_library(${name} MODULE ${ARGN}
              ${CMAKE_CURRENT_BINARY_DIR}/${name}_plug_in.cc)
  target_link_libraries(${name} PRIVATE nsfd::interface)
  # the functions of nsfd are those of the program that loads it
  set_target_properties(${name} PROPERTIES PREFIX "" SUFFIX .so)
  target_compile_options(${name} PRIVATE -Wall -Wextra $<$<CONFIG:>:-O2>)
  # a class that is called like one of the program stays one of its own
  target_link_options(${name} PRIVATE
                      -Wl,--version-script=${nsfd_PACKAGE}/plug_in.map)
endfunction()
