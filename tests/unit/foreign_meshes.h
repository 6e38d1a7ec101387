#pragma once

#include "named_mesh_scene.h"

#include <string>

namespace nsfd
{
  namespace test
  {
    /** Entries of a section Mesh that read a file of tests/meshes. */
    inline std::string mesh_of_tests(const std::string &name,
                                     const std::string &more = "")
    {
      return "set type = file\nset file = " NSFD_SOURCE_DIR "/tests/meshes/" +
             name + "\n" + more;
    }

    /** The errors of a scene with a mesh of this content. */
    inline std::string errors_of_content(const unsigned int dimension,
                                         const std::string &name,
                                         const std::string &content,
                                         const std::string &more = "")
    {
      const TemporaryFile file(name, content);
      return errors_of(mesh_scene(dimension, file.entries(more)));
    }

    inline std::string content_of_test(const std::string &name)
    {
      std::ifstream in(NSFD_SOURCE_DIR "/tests/meshes/" + name,
                       std::ios::binary);
      return {std::istreambuf_iterator<char>(in), {}};
    }

    /** @p text with its first @p from in another form. */
    inline std::string with(std::string text, const std::string &from,
                            const std::string &to)
    {
      const std::size_t at = text.find(from);
      EXPECT_NE(at, std::string::npos) << from;
      return at == std::string::npos ? text : text.replace(at, from.size(), to);
    }

    inline void expect_part(const std::string &errors, const std::string &part)
    {
      EXPECT_NE(errors.find(part), std::string::npos) << part << "\n" << errors;
    }
  } // namespace test
} // namespace nsfd
