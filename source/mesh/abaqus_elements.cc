#include "abaqus_elements.h"

#include <map>
#include <utility>

namespace nsfd::abaqus
{
  ElementType element_type(const std::string &name)
  {
    const auto begins = [&](const char *word) {
      return name.rfind(word, 0) == 0;
    };
    if (begins("COH"))
      return {0, false,
              "cohesive elements are not needed: nsfd has its laws on the "
              "faces between cells; leave them out, and write `merge vertices "
              "= true` if the two sides have nodes of their own"};
    for (const char *word : {"C3D5", "DC3D5"})
      if (name == word)
        return {0, false,
                "pyramids cannot be used; mesh with tetrahedra alone (C3D4) "
                "or hexahedra alone (C3D8)"};
    for (const char *word : {"CIN", "CCL", "CGAX", "SC", "GK", "DS", "F2D",
                             "F3D", "PC3D", "Q3D", "EC3D", "CSS"})
      if (begins(word))
        return {0, false,
                "there is no such cell; mesh with CPE3, CPE4, CPS3 or CPS4 in "
                "the plane, C3D4, C3D6 or C3D8 in space"};
    for (const char *word : {"C3D", "DC3D", "AC3D"})
      if (begins(word))
        return {3, false, ""};
    for (const char *word :
         {"CPS", "CPE", "CGPE", "CAX", "DC2D", "DCAX", "AC2D"})
      if (begins(word))
        return {2, false, ""};
    for (const char *word :
         {"M3D", "SFM3D", "STRI", "R3D", "S3", "S4", "S6", "S8", "S9"})
      if (begins(word))
        return {2, true, ""};
    for (const char *word : {"T2D", "T3D", "B2", "B3", "R2D", "RAX"})
      if (begins(word))
        return {1, true, ""};
    return {};
  }

  unsigned int n_corners(const unsigned int dimension,
                         const std::size_t n_nodes)
  {
    static const std::map<std::pair<unsigned int, std::size_t>, unsigned int>
        known = {{{1, 2}, 2},  {{1, 3}, 2},  {{2, 3}, 3},  {{2, 6}, 3},
                 {{2, 4}, 4},  {{2, 8}, 4},  {{2, 9}, 4},  {{3, 4}, 4},
                 {{3, 10}, 4}, {{3, 6}, 6},  {{3, 15}, 6}, {{3, 18}, 6},
                 {{3, 8}, 8},  {{3, 20}, 8}, {{3, 27}, 8}};
    const auto found = known.find({dimension, n_nodes});
    return found == known.end() ? 0 : found->second;
  }

  std::vector<unsigned int> face_of(const unsigned int dimension,
                                    const unsigned int n_corners,
                                    const unsigned int face)
  {
    using Faces = std::vector<std::vector<unsigned int>>;
    static const std::map<std::pair<unsigned int, unsigned int>, Faces> known =
        {{{2, 3}, {{0, 1}, {1, 2}, {2, 0}}},
         {{2, 4}, {{0, 1}, {1, 2}, {2, 3}, {3, 0}}},
         {{3, 4}, {{0, 1, 2}, {0, 3, 1}, {1, 3, 2}, {2, 3, 0}}},
         {{3, 6},
          {{0, 1, 2}, {3, 5, 4}, {0, 3, 4, 1}, {1, 4, 5, 2}, {2, 5, 3, 0}}},
         {{3, 8},
          {{0, 1, 2, 3},
           {4, 7, 6, 5},
           {0, 4, 5, 1},
           {1, 5, 6, 2},
           {2, 6, 7, 3},
           {3, 7, 4, 0}}}};
    const auto found = known.find({dimension, n_corners});
    if (found == known.end() || face == 0 || face > found->second.size())
      return {};
    return found->second[face - 1];
  }

  std::vector<unsigned int> row_by_row(std::vector<unsigned int> corners,
                                       const unsigned int dimension)
  {
    if (corners.size() == 4 && dimension == 2)
      std::swap(corners[2], corners[3]);
    if (corners.size() == 8) {
      std::swap(corners[2], corners[3]);
      std::swap(corners[6], corners[7]);
    }
    return corners;
  }
} // namespace nsfd::abaqus
