#pragma once

#include "core/communicator.h"
#include "core/neighbor_messages.h"
#include "discretization/bodies.h"

#include <array>
#include <vector>

namespace nsfd
{
  /**
   * The bodies seen from the faces without their inertia: U = H v, r = H^T P,
   * and the exchange of what the two sides of a point contribute on different
   * ranks. Vectors over points are in the local frames, dim entries per point;
   * vectors over bodies have Bodies::n_dofs() entries.
   */
  template <int dim>
  class FaceTraces
  {
  public:
    FaceTraces(const Communicator &communicator, const Bodies &bodies,
               const InterfacePoints<dim> &points);
    virtual ~FaceTraces() = default;

    /** U = H v. */
    void relative_velocity(const double *velocity, double *result) const;

    /**
     * By point: its sides can move against each other; not where they are one
     * node, as on a face that ends inside a body. Collective.
     */
    virtual std::vector<char> parting() const
    {
      return std::vector<char>(points_.n_points, 1);
    }

    /** H v of a motion that bodies that share nodes share. */
    virtual void jumps(const double *velocity, double *result) const
    {
      relative_velocity(velocity, result);
    }

    /** r = H^T P. */
    void generalised_impulse(const double *impulse, double *result) const;

    const InterfacePoints<dim> &points() const { return points_; }
    const Bodies &bodies() const { return bodies_; }
    const Communicator &communicator() const { return communicator_; }

    /**
     * Complete contributions of both sides at shared points: @p side holds
     * `stride` values per point for body 1 and body 2.
     */
    void exchange(std::array<double *, 2> side, unsigned int stride) const
    {
      start_exchange(side, stride);
      finish_exchange(side, stride);
    }

    /** In two parts: what this rank computes is read by the first one only. */
    void start_exchange(std::array<double *, 2> side,
                        unsigned int stride) const;
    void finish_exchange(std::array<double *, 2> side,
                         unsigned int stride) const;

    /** Per class, those whose points other ranks wait for first. */
    const BodyOrder &order() const { return order_; }

  protected:
    /** Bodies or points are others than before. */
    void reset_traces();
    /** Into cartesian_. */
    void to_cartesian(const double *local) const;
    /** The sum of both sides, complete, in the local frames. */
    void add_sides(double *local) const;
    /** T^T of a class of bodies. */
    const Block &trace_transposed(const std::size_t k) const
    {
      return trace_transposed_[k];
    }

    const Communicator &communicator_;
    const Bodies &bodies_;
    const InterfacePoints<dim> &points_;
    mutable std::vector<double> cartesian_, side_1_, side_2_;

  private:
    BodyOrder order_;
    std::vector<Block> trace_transposed_; ///< by class
    mutable NeighborMessages<double> messages_;
  };
} // namespace nsfd
