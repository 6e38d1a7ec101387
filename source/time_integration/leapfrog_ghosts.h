#pragma once

#include "joined/corner_groups.h"
#include "joined/ghost_layer.h"
#include "joined/hanging_nodes.h"
#include "state/state.h"

#include <memory>
#include <optional>
#include <vector>

namespace nsfd
{
  /**
   * What Leapfrog does on several ranks. Each of them takes the step of its own
   * cells and of the ghosts around them: releases, forces and problems of the
   * nodes with an own cell are computed on all ranks that have one there, from
   * the same numbers in the same order. Only the velocities of the ghosts at
   * nodes beyond are sent, once per step. On one rank nothing happens here.
   * Where the layer is all of the mesh every rank takes the whole step as if it
   * were alone, and only the forces of the cells are divided.
   */
  template <int dim>
  class LeapfrogGhosts
  {
  public:
    /** @p layer around the cells of @p own; null: all cells are here. */
    LeapfrogGhosts(const Communicator &communicator,
                   const Discretization<dim> &own,
                   std::unique_ptr<const GhostLayer<dim>> layer);

    /** All that this rank steps. */
    const Discretization<dim> &discretization() const
    {
      return layer_ ? layer_->all() : own_;
    }
    const GhostCells *cells() const
    {
      return layer_ && !layer_->is_whole() ? &layer_->cells() : nullptr;
    }
    /** Cells of other ranks, where every one takes the whole step; or null. */
    const GhostCells *divided() const
    {
      return layer_ && layer_->is_whole() ? &layer_->cells() : nullptr;
    }
    /** The ranks that take a step together. */
    const Communicator &communicator() const
    {
      return divided() ? alone_ : communicator_;
    }
    /** By point with ghosts, that without, or unsigned(-1); empty: the same. */
    const std::vector<unsigned int> &own_points() const { return own_points_; }
    /** Null on one rank. */
    const GhostLayer<dim> *layer() const { return layer_.get(); }

    /** A state of the cells of this rank, with ghosts. Collective. */
    State with(State own) const;
    State without(State all) const;
    /** A value of each point. Collective. */
    std::vector<double> with_points(const std::vector<double> &own) const;
    /** What is of no cell and known to all ranks: of the first one alone. */
    void count_once(State &own) const;

    /** Before the first exchange; @p hanging nodes follow others. Collective.
     */
    void set_mesh(const JoinedMesh<dim> &mesh,
                  const HangingNodes<dim> &hanging);
    /** Velocities of nodes that are not whole here, while others are used. */
    void start(const CornerGroups<dim> &groups) const;
    void finish(CornerGroups<dim> &groups) const;
    /** Motion of these nodes as their ranks have it from the corners. */
    void fetch_motion(CornerGroups<dim> &groups) const;

    /** Sums over the groups of all ranks. Collective. */
    double sum(const CornerGroups<dim> &groups,
               std::vector<double> &terms) const;
    /** Of rows of terms one after the other, which may change. */
    std::vector<double> sums(const CornerGroups<dim> &groups,
                             std::vector<double> &terms,
                             std::size_t rows) const;
    double dot(const CornerGroups<dim> &groups, const std::vector<double> &a,
               const std::vector<double> &b) const;

  private:
    const Communicator &communicator_;
    const Communicator alone_;
    const Discretization<dim> &own_;
    const std::unique_ptr<const GhostLayer<dim>> layer_;
    std::vector<unsigned int> own_points_;
    std::optional<GhostCells::Wanted> corners_; ///< of nodes beyond
    mutable std::vector<double> products_;
  };
} // namespace nsfd
