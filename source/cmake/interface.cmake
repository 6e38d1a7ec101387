# What plug-ins must have been built against: a hash of all public headers and of
# the version of deal.II, in nsfd/core/interface.h. A comment that changes changes it as well; the
# alternative, to number interfaces by hand, is forgotten when it matters.
file(GLOB_RECURSE headers CONFIGURE_DEPENDS RELATIVE ${CMAKE_SOURCE_DIR}/include
     ${CMAKE_SOURCE_DIR}/include/nsfd/*.h)
list(SORT headers)
# some have classes of deal.II in them
set(hashes "deal.II ${DEAL_II_PACKAGE_VERSION}\n")
foreach(header ${headers})
  file(SHA256 ${CMAKE_SOURCE_DIR}/include/${header} hash)
  string(APPEND hashes "${header} ${hash}\n")
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS
               ${CMAKE_SOURCE_DIR}/include/${header})
endforeach()
string(SHA256 NSFD_INTERFACE "${hashes}")
string(SUBSTRING ${NSFD_INTERFACE} 0 12 NSFD_INTERFACE)
configure_file(${CMAKE_CURRENT_LIST_DIR}/interface.h.in
               ${CMAKE_BINARY_DIR}/include/nsfd/core/interface.h @ONLY)
