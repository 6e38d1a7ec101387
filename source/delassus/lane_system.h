#pragma once

#include "linear_algebra/lane_kernels.h"

#include "core/neighbor_messages.h"
#include "dynamics.h"
#include "inner_solver.h"

#include <algorithm>

namespace nsfd
{
  /**
   * Newton systems of the element-wise path in single precision, body by body
   * and face by face over lanes. Components are scaled to a diagonal of W of
   * one, so nothing leaves the range of floats. Answers do not depend on the
   * number of ranks.
   */
  template <int dim>
  class LaneSystem
  {
  public:
    LaneSystem(const Communicator &communicator, const Bodies &bodies,
               const InterfacePoints<dim> &points);

    /** After M_hat has changed. */
    void reinit(const Dynamics<dim> &dynamics);

    /** (W + D) x = r by conjugate gradients; returns the iterations. */
    unsigned int conjugate_gradients(const InnerSystem &system,
                                     const std::vector<double> &r,
                                     std::vector<double> &x);

    /**
     * (I - J (W + shift R - R)) x = r by GMRES, preconditioned from the right.
     * Faces that stick all around an edge make W singular, and the system
     * without a shift may have no solution; with a shift, impulses move along
     * the null space until one of these faces lets go.
     */
    unsigned int gmres(const InnerSystem &system, const std::vector<double> &r,
                       std::vector<double> &x);

    unsigned long long applications() const { return applications_; }

  private:
    using Floats = std::vector<float>;

    void group_bodies();
    void group_faces();
    void place_points();
    void set_values(const Dynamics<dim> &dynamics, lane::BodyGroup &group,
                    const std::vector<unsigned int> &members);
    void set_faces(const Dynamics<dim> &dynamics, lane::FaceGroup &group);
    void prepare(const std::vector<double> &D);
    void prepare_coupled(const InnerSystem &system);
    /** To the slots, through the bodies, and from other ranks. */
    void apply(const Floats &p);
    void start_exchange();
    void finish_exchange();
    void set_zero(Floats &v) const { std::fill(v.begin(), v.end(), 0.f); }
    double product(const Floats &a, const Floats &b);
    double orthogonalise(unsigned int k, double &scale, double *h);
    void reduce(lane::ExactSum *sums, unsigned int count) const;
    template <typename Function>
    void for_components(const lane::FaceGroup &group,
                        const Function &function) const;

    const Communicator &communicator_;
    const Bodies &bodies_;
    const InterfacePoints<dim> &points_;
    std::vector<lane::BodyGroup> body_groups_;
    std::vector<std::vector<unsigned int>> members_; ///< bodies, per group
    std::vector<lane::FaceGroup> face_groups_;
    std::vector<std::vector<double>> face_blocks_; ///< scaled, packed, by lane
    std::vector<double> scale_; ///< per component, square root of its W
    double unit_ = 1.;     ///< of the bodies' blocks: the largest diagonal of W
    std::size_t size_ = 0; ///< of a vector over faces
    std::size_t n_slots_ = 0;               ///< floats of the bodies' slots
    std::array<std::vector<int>, 2> place_; ///< per point, of its sides
    struct Extra {
      int slot, place;
    };
    std::vector<Extra> extras_;
    Floats X_, Y_; ///< at the slots
    Floats x_, r_, z_, p_, w_;
    std::vector<Floats> basis_;
    std::vector<double> terms_, part_, diagonal_, work_;
    NeighborMessages<float> messages_;
    unsigned long long applications_ = 0;
  };
} // namespace nsfd
