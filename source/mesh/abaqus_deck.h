#pragma once

#include <array>
#include <iosfwd>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace nsfd::abaqus
{
  struct Node {
    std::array<double, 3> x{};
    unsigned int line = 0;
  };

  struct Element {
    std::string type;
    unsigned int dimension = 0;
    std::vector<long> corners; ///< labels of nodes, in Abaqus's order
    unsigned int line = 0;
    bool is_curved = false; ///< has nodes besides its corners
  };

  /** A node or element: the instance it is of, and its label there. */
  using Member = std::pair<std::size_t, long>;

  struct Set {
    std::string name; ///< as it was first written
    bool is_internal = false;
    std::vector<Member> members; ///< sorted, each once
  };

  /** Sets by their name in upper case. */
  using Sets = std::map<std::string, Set>;

  struct Surface {
    std::string name;
    struct Side {
      Member element;
      std::string side; ///< S1, SPOS, ...
      unsigned int line = 0;
    };
    std::vector<Side> sides;
  };

  /** What has sets of its own: a part, or the assembly. */
  struct Scope {
    Sets element_sets, node_sets;
    std::vector<Surface> surfaces;
  };

  /** Its own members have the instance 0. */
  struct Part : Scope {
    std::string name;
    std::map<long, Node> nodes;
    std::map<long, Element> elements;
  };

  /** A part at its place: moved, then turned about an axis. */
  struct Instance {
    std::string name;
    std::size_t part = 0;
    std::array<double, 3> translation{}, axis_begin{}, axis_end{};
    double angle = 0.; ///< degrees
  };

  /** Members of the sets of the assembly name their instance. */
  struct Deck {
    std::vector<Part> parts;
    std::vector<Instance> instances;
    Scope assembly;
    std::map<std::string, std::size_t> skipped; ///< elements by their type
  };

  /**
   * Nodes, elements, sets, surfaces, parts and instances of an input deck. A
   * deck without parts has one part and one instance of it, both without name.
   * What is wrong goes into @p problems, with its line; the first one ends it.
   */
  Deck read_deck(std::istream &in, unsigned int dimension,
                 std::vector<std::string> &problems);
} // namespace nsfd::abaqus
