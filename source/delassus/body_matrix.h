#pragma once

#include "point_traces.h"

#include "bulk_traction.h"
#include "linear_algebra/spd_solver.h"

#include <cstdint>
#include <vector>

namespace nsfd
{
  /**
   * The rows of this rank of
   *
   *     M + f (K + bonds) + H^T diag(s) H,
   *
   * with a pattern that does not depend on what is bonded: bodies with a
   * common face are coupled.
   */
  template <int dim>
  class BodyMatrix
  {
  public:
    using Bond = typename BulkTraction<dim>::Bond;

    BodyMatrix(const Bodies &bodies, const InterfacePoints<dim> &points,
               std::array<std::vector<PointTrace>, 2> traces,
               std::vector<Bond> bonds, long long first_dof);

    /**
     * @p shares of the step; @p bonded one per point; @p stiffness s
     * one per point and component, or null.
     */
    const SparseRows &assemble(const StepShares &shares,
                               const std::vector<std::uint8_t> &bonded,
                               const double *stiffness);

  private:
    /** A body that couples with a row of bodies: its columns there. */
    struct Neighbor {
      bool elsewhere = false; ///< on another rank: ghosts come last in a row
      long long first = 0;    ///< global
      unsigned int n_dofs = 0, offset = 0;
    };
    Neighbor neighbor(long long first, unsigned int n_dofs) const;
    void number_ghosts();
    void build_pattern();
    double *block(unsigned int body, long long first, std::size_t &stride);
    void add_face(const typename InterfacePoints<dim>::Face &face,
                  unsigned int row_side, unsigned int column_side,
                  const StepShares &shares,
                  const std::vector<std::uint8_t> &bonded,
                  const double *stiffness);
    const double *step_traction(const PointTrace &trace, unsigned int component,
                                const StepShares &shares,
                                std::vector<double> &work) const;

    const Bodies &bodies_;
    const InterfacePoints<dim> &points_;
    std::array<std::vector<PointTrace>, 2> traces_;
    std::vector<Bond> bonds_;
    long long first_dof_;
    std::vector<std::vector<Neighbor>> neighbors_; ///< by body, ascending
    SparseRows matrix_;
  };
} // namespace nsfd
