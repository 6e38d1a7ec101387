#pragma once

#include <string>
#include <vector>

namespace nsfd
{
  /** A library of parts built outside of this tree, once it is loaded. */
  struct PlugIn {
    std::string name;               ///< as nsfd_add_plug_in() has it
    std::string file;               ///< full path
    std::string checksum;           ///< of its bytes, 16 hexadecimal digits
    std::vector<std::string> parts; ///< names that it has registered
    bool used = false;              ///< the scene names it, or one of its parts
  };

  /** In the order in which they were loaded; the same on all ranks. */
  const std::vector<PlugIn> &loaded_plug_ins();

  /** What registries tell of parts, see registry.h. */
  namespace plug_ins
  {
    /** A part gets @p name. @return the plug-in that is being loaded; empty
     * for the parts of the program, before `main` begins. */
    std::string owner_of(const std::string &name);

    /** The name belongs to a part of @p owner: what is being loaded is refused.
     */
    void refuse_name(const std::string &name, const std::string &owner);

    /** A part of this plug-in is made; nothing for an empty name. */
    void note_use(const std::string &plug_in);
  } // namespace plug_ins
} // namespace nsfd

#if defined(_LIBCPP_VERSION)
#define NSFD_STANDARD_LIBRARY "libc++"
#elif defined(_GLIBCXX_DEBUG)
#define NSFD_STANDARD_LIBRARY "libstdc++ in debug mode"
#elif _GLIBCXX_USE_CXX11_ABI
#define NSFD_STANDARD_LIBRARY "libstdc++"
#else
#define NSFD_STANDARD_LIBRARY "libstdc++ without the C++11 ABI"
#endif

/**
 * What a program and its plug-ins must agree in, after nsfd/core/interface.h:
 * the public headers, word by word, deal.II, and the standard library.
 */
#define NSFD_BUILT_FOR                                                         \
  "nsfd " NSFD_VERSION ", interface " NSFD_INTERFACE ","                       \
  " " NSFD_STANDARD_LIBRARY

/** What precedes that in the file of a plug-in, where it is read before any of
 * its code runs. */
#define NSFD_PLUG_IN_MARK "nsfd plug-in: "

/** Once in a plug-in; nsfd_add_plug_in() of the CMake package adds it. */
#define NSFD_PLUG_IN(name)                                                     \
  extern "C" {                                                                 \
  extern const char nsfd_plug_in[];                                            \
  __attribute__((used)) const char nsfd_plug_in[] =                            \
      NSFD_PLUG_IN_MARK name "; " NSFD_BUILT_FOR;                              \
  }
