#include "cell_shapes.h"

namespace nsfd
{
  namespace
  {
    const std::vector<CellShapeTopology> shapes = {
        {"triangles",
         2,
         3,
         {{1, 2}, {2, 0}, {0, 1}},
         {{0, 1}, {1, 2}, {2, 0}},
         {0, 2, 1}},
        {"quads",
         2,
         4,
         {{1, 2}, {3, 0}, {0, 3}, {2, 1}},
         {{0, 2}, {1, 3}, {0, 1}, {2, 3}},
         {0, 2, 1, 3}},
        {"tetrahedra",
         3,
         4,
         {{1, 2, 3}, {2, 0, 3}, {0, 1, 3}, {0, 2, 1}},
         {{0, 1, 2}, {1, 0, 3}, {0, 2, 3}, {2, 1, 3}},
         {0, 2, 1, 3}},
        {"prisms",
         3,
         6,
         {{1, 2, 3}, {2, 0, 4}, {0, 1, 5}, {5, 4, 0}, {3, 5, 1}, {4, 3, 2}},
         {{0, 1, 2}, {3, 4, 5}, {0, 1, 3, 4}, {1, 2, 4, 5}, {2, 0, 5, 3}},
         {3, 4, 5, 0, 1, 2}},
        {"hexes",
         3,
         8,
         {{1, 2, 4},
          {3, 0, 5},
          {0, 3, 6},
          {2, 1, 7},
          {6, 5, 0},
          {4, 7, 1},
          {7, 4, 2},
          {5, 6, 3}},
         {{0, 2, 4, 6},
          {1, 3, 5, 7},
          {0, 1, 4, 5},
          {2, 3, 6, 7},
          {0, 1, 2, 3},
          {4, 5, 6, 7}},
         {4, 5, 6, 7, 0, 1, 2, 3}}};
  } // namespace

  const CellShapeTopology *find_cell_shape(const unsigned int dimension,
                                           const unsigned int n_corners)
  {
    for (const CellShapeTopology &shape : shapes)
      if (shape.dimension == dimension && shape.n_corners == n_corners)
        return &shape;
    return nullptr;
  }
} // namespace nsfd
