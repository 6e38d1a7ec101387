#pragma once

#include "surface_cells.h"

#include <cstdint>
#include <vector>

namespace nsfd
{
  struct SceneInput;

  /** Two numbers in any order. */
  using UnorderedPair = std::uint64_t;
  inline UnorderedPair pair_of(const unsigned int a, const unsigned int b)
  {
    return a < b ? (UnorderedPair(a) << 32 | b) : (UnorderedPair(b) << 32 | a);
  }

  /**
   * The places of all surfaces, where contacts keep what they keep from step to
   * step: nodes on faces of cells, balls and, in space, edges, in this order.
   */
  template <int dim>
  class ContactPlaces
  {
  public:
    ContactPlaces(const SurfaceCells<dim> &cells, const BodyTable &table);

    std::size_t size() const;
    /** Those of nodes on faces, which come first. */
    std::size_t n_of_faces() const { return first_.back(); }
    std::size_t first(const std::size_t cell) const { return first_[cell]; }
    std::size_t of_node(unsigned int cell, unsigned int face,
                        unsigned int node) const;
    std::size_t of_ball(const unsigned int body) const
    {
      return n_of_faces() + body;
    }
    /** Of an edge between two merged nodes. */
    std::size_t of_edge(unsigned int node_1, unsigned int node_2) const;
    /** The cell of a node on a face; -1: the place is no such node. */
    int cell_of(std::size_t place) const;

  private:
    const SurfaceCells<dim> &cells_;
    const std::size_t n_bodies_;
    std::vector<std::size_t> first_;   ///< per cell, then of balls
    std::vector<UnorderedPair> edges_; ///< in space: merged nodes, sorted
  };

  /** Which contact block of the scene two bodies have, by their materials. */
  class ContactBlocks
  {
  public:
    ContactBlocks(const SceneInput &input, const BodyTable &table);

    /** -1: they do not touch. */
    int of(const unsigned int body_1, const unsigned int body_2) const
    {
      return blocks_[table_.bodies[body_1].material * n_materials_ +
                     table_.bodies[body_2].material];
    }
    /** There is a body that it may touch. */
    bool may_touch(unsigned int body) const;

  private:
    const BodyTable &table_;
    const std::size_t n_materials_;
    std::vector<int> blocks_; ///< n_materials^2
  };
} // namespace nsfd
