#pragma once

#include "named_mesh.h"

#include <string>
#include <vector>

namespace nsfd::vtk
{
  /** Values of cells. */
  struct Array {
    std::string name;
    std::size_t n_components = 1;
    std::vector<double> values; ///< cell by cell
  };

  /** An unstructured grid of VTK, as a file says it. */
  struct Grid {
    std::vector<double> coordinates;          ///< x, y, z per point
    std::vector<double> first = {0.}, points; ///< cell c from first[c] on
    std::vector<double> types;                ///< by VTK's numbers
    std::vector<Array> cell_arrays;
  };

  /**
   * Cells, and faces where there are some, by their corners. The whole numbers
   * of the array @p group_data are groups; if it is empty, those of the first
   * one that programs use for this. Arrays of one component are fields, of
   * three components data of elements.
   */
  NamedMesh mesh_of(const Grid &grid, unsigned int dimension,
                    const std::string &group_data,
                    std::vector<std::string> &problems);

  /** Legacy format, ASCII or binary. What is wrong is one sentence. */
  Grid read_legacy(const std::string &file, std::vector<std::string> &problems);

  /**
   * XML format, ASCII, base64 or raw, inline or appended, with zlib or without.
   * Takes memory in proportion to the size of the file.
   */
  Grid read_xml(const std::string &file, std::vector<std::string> &problems);
} // namespace nsfd::vtk
