#pragma once

#include "constrained_delaunay.h"

#include <string>
#include <vector>

namespace nsfd
{
  struct NamedMesh;
  struct SizeField;

  /**
   * What a plane mesh must keep: lines between points, and of which set of
   * groups the parts are that they separate. Lines meet at points only.
   */
  struct PlaneOutline {
    struct Line {
      unsigned int first, last; ///< points
      unsigned int set;         ///< of its faces, of the mesh of groups
    };
    /** A place in a part, and the set of the cells there. */
    struct Inside {
      PlanePoint place;
      unsigned int set;
    };
    std::vector<PlanePoint> points;
    std::vector<Line> lines;
    std::vector<Inside> parts; ///< empty: all of it, of set 0
    /// who drew a point on a straight line wants a node there: where a crack
    /// ends
    bool keeps_straight_points = false;
  };

  /** Lines that the user draws: a closed one around, and others in it. */
  struct PlaneDrawing {
    struct Path {
      std::vector<PlanePoint> points;
      unsigned int set = 0;
      std::string name; ///< for messages
    };
    std::vector<PlanePoint> boundary; ///< corners
    std::vector<Path> paths;          ///< open lines
  };

  /**
   * Its outline: lines are divided where they cross or touch. What lies outside
   * is a problem.
   */
  PlaneOutline outline_of(const PlaneDrawing &drawing,
                          std::vector<std::string> &problems);

  /**
   * Of a mesh of triangles and quads: its boundary, faces of groups, faces
   * between cells of different groups.
   */
  PlaneOutline outline_of(const NamedMesh &mesh);

  /** Points on the lines of an outline, and the edges between them. */
  struct OutlineNodes {
    std::vector<PlanePoint> points;
    std::vector<std::array<unsigned int, 2>> edges;
    std::vector<unsigned int> set; ///< per edge
  };

  /**
   * Nodes on the lines, about as far apart as @p size says and not quite
   * evenly. Corners, ends and junctions stay; a line that turns by little at a
   * point forgets it.
   */
  OutlineNodes place_nodes(const PlaneOutline &outline, const SizeField &size,
                           unsigned int seed);
} // namespace nsfd
