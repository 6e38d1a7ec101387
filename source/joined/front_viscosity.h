#pragma once

#include "core/communicator.h"
#include "discretization/discretization.h"

#include <vector>

namespace nsfd
{
  class Archive;

  /**
   * A viscous pressure that spreads sharp fronts over some cells: behind a
   * front that is sharper than the mesh an explicit scheme rings, and tension
   * behind a compressive front would break faces. In a cell with the mean rate
   * of dilatation D
   *
   *   p = -psi eta D,   eta = 2 b K / omega,   psi = min(1, (s / 0.15)^3),
   *
   * s the second difference of D over the faces of the cell, over the sum of
   * the sizes of D in it; K the bulk modulus, omega the highest frequency of
   * the free cell, b the share of critical damping of that mode (linear bulk
   * viscosity: von Neumann & Richtmyer 1950, as in explicit codes). psi is 1 at
   * a front and in waves of less than 8 cells, and falls with the sixth power
   * of cell size over wavelength. The rate is that of the step
   * before, so that v.(M - h^2 K/4 - h C/2) v > 0 bounds the step:
   * h < (2/omega) (sqrt(1 + b^2) - b).
   */
  class FrontViscosity
  {
  public:
    /** Nothing acts. */
    FrontViscosity() = default;
    /** @p share is b. */
    template <int dim>
    FrontViscosity(const Discretization<dim> &discretization, double share);

    bool acts() const { return !eta_.empty(); }

    /** By cell: of the present forces. -p, Pa; (q_k) and (v_{k-1/2}): tr eps
     * and its rate. */
    std::vector<double> tension, dilatation, rate;
    /** Of the next ones: psi eta, Pa s. */
    std::vector<double> viscosity;

    /**
     * The dilatation of a cell has become @p now in a step of @p time_step
     * (0: there was none): its tension. @p volume in m^3 or m^2.
     */
    void update(const std::size_t cell, const double now,
                const double time_step, const double volume)
    {
      const std::size_t n = eta_.size();
      if (holds) {
        dilatation[cell] = now;
        return;
      }
      const double D =
          time_step > 0. ? (now - dilatation[cell]) / time_step : 0.;
      const double next = viscosity[cell] * D;
      terms_[cell] = volume * tension[cell] * D;
      terms_[n + cell] = volume * next * D;
      terms_[2 * n + cell] = volume * next * now;
      tension[cell] = next;
      dilatation[cell] = now;
      rate[cell] = D;
    }

    /** Tensions stay what they are: those of a checkpoint. */
    bool holds = false;

    /** Sums over the cells of volume times tension times ..., in J or W. */
    struct Powers {
      double before = 0.; ///< tension of the forces before, rate of the step
      double after = 0.;  ///< of the present forces, rate of the step
      double stored = 0.; ///< of the present forces, dilatation
    };
    /** After all cells: those, and psi of the next forces. Collective. */
    Powers finish(const Communicator &communicator);

    /** Of @p first_dof: places in a vector over unknowns, three per cell. */
    void serialize(Archive &archive, const std::vector<std::size_t> &first_dof);

  private:
    std::vector<double> eta_; ///< Pa s
    std::vector<std::size_t> first_neighbor_;
    std::vector<unsigned int> neighbor_;
    std::vector<double> terms_;
  };

  /** What of the longest step is left with a share @p b of critical damping. */
  double step_share(double b);
} // namespace nsfd
