#pragma once

#include "inner_solver.h"
#include "simd_layout.h"

#include "core/neighbor_messages.h"

#include <algorithm>

namespace nsfd
{
  /**
   * Newton systems of the local path in single precision, body by body
   * and face by face in batches, one per lane of a SIMD vector. Answers do not
   * depend on the number of ranks.
   */
  template <int dim>
  class SimdSystem
  {
  public:
    SimdSystem(const Communicator &communicator, const Bodies &bodies,
               const InterfacePoints<dim> &points);

    /** After M_hat has changed. Collective. */
    void reinit(const DelassusOperator<dim> &delassus)
    {
      layout_.set_values(delassus);
    }

    /** (W + D) x = r by conjugate gradients; returns the iterations. */
    unsigned int conjugate_gradients(const InnerSystem &system,
                                     const std::vector<double> &r,
                                     std::vector<double> &x);

    /**
     * (I - J (W + shift R - R)) x = r by GMRES, preconditioned from the right.
     * Faces that stick all around an edge make W singular, and the system
     * without a shift may have no solution; with a shift, impulses move along
     * the null space until one of these faces is released.
     */
    unsigned int gmres(const InnerSystem &system, const std::vector<double> &r,
                       std::vector<double> &x);

    unsigned long long applications() const { return applications_; }

  private:
    using Floats = std::vector<float>;

    void prepare(const std::vector<double> &D);
    void prepare_coupled(const InnerSystem &system);
    /** To the slots, through the bodies, and from other ranks. */
    void apply(const Floats &p);
    void start_exchange();
    void finish_exchange();
    void set_zero(Floats &v) const { std::fill(v.begin(), v.end(), 0.f); }
    double product(const Floats &a, const Floats &b);
    double orthogonalise(unsigned int k, double &scale, double *h);
    void reduce(simd::ExactSum *sums, unsigned int count) const;
    /** The largest entry of @p r over the roots of the diagonal of W, or times
     * them. */
    double scale_of(const std::vector<double> &r, bool by_velocity) const;
    struct Directions;
    struct Basis;

    const Communicator &communicator_;
    const InterfacePoints<dim> &points_;
    SimdLayout<dim> layout_;
    Floats X_, Y_; ///< at the slots
    Floats x_, r_, z_, p_, w_;
    std::vector<Floats> basis_;
    std::vector<double> terms_, part_, diagonal_, work_;
    NeighborMessages<float> messages_;
    unsigned long long applications_ = 0;
  };
} // namespace nsfd
