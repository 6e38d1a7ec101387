#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace nsfd::abaqus
{
  /** What the name of an element type says; all of it in upper case. */
  struct ElementType {
    unsigned int dimension = 0; ///< of its shape; 0: it has none
    bool is_structural = false; ///< shell, membrane, rigid or surface element
    /// why it is no cell and what to do; empty if it may be one
    std::string refusal;
  };

  ElementType element_type(const std::string &name);

  /** Corners of an element of @p n_nodes nodes, which come first; 0: none. */
  unsigned int n_corners(unsigned int dimension, std::size_t n_nodes);

  /** Corners of the face S1, S2, ... in Abaqus's order; empty: no such face. */
  std::vector<unsigned int> face_of(unsigned int dimension,
                                    unsigned int n_corners, unsigned int face);

  /** Corners that go round, row by row. */
  std::vector<unsigned int> row_by_row(std::vector<unsigned int> corners,
                                       unsigned int dimension);
} // namespace nsfd::abaqus
