#pragma once

#include "ghost_cells.h"

#include "core/communicator.h"
#include "core/instruction_sets.h"
#include "discretization/discretization.h"

#include <algorithm>
#include <limits>
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
   *
   * With c = psi eta and the rates D- and D+ before and after a kick of length
   * k the pressure c- D- takes k c- D-.(D- + D+)/2, which is negative where the
   * rate changes its sign. The kinetic energy of the scheme is therefore less
   * by h c D^2/4 of every cell, and what is taken is
   *
   *   k c- ((D- + D+)/2)^2 - (k c- - h c+) (D+)^2/4,
   *
   * never negative as long as h c+ >= -k c- r (2 + r), r = D-/D+: psi falls no
   * faster than that.
   */
  class FrontViscosity
  {
  public:
    /** Nothing acts. */
    FrontViscosity() = default;
    /** @p share is b; @p ghosts of the cells, if there may be some, outlive it.
     */
    template <int dim>
    FrontViscosity(const Discretization<dim> &discretization, double share,
                   const GhostCells *ghosts = nullptr);

    bool acts() const { return acts_; }

    /** By cell: of the present forces. -p, Pa; (q_k) and (v_{k-1/2}): tr eps
     * and its rate; psi eta, Pa s. */
    std::vector<double> tension, dilatation, rate, present_viscosity;
    /** Of the next ones: psi eta, Pa s. */
    std::vector<double> viscosity;

    /** The next updates are of a step of length @p h (0: there was none) after
     * a kick of length @p kick, s. */
    void begin_step(const double h, const double kick)
    {
      h_ = h;
      kick_ = kick;
    }

    /** The dilatation of a cell has become @p now: its tension. @p volume in
     * m^3 or m^2. */
    void update(const std::size_t cell, const double now, const double volume)
    {
      update_block<1>(cell, &now, &volume);
    }

    /** The same of @p n cells one after the other. */
    template <unsigned int n>
    NSFD_INLINE void update_block(const std::size_t first, const double *now,
                                  const double *volume)
    {
      if (holds) {
        std::copy_n(now, n, &dilatation[first]);
        return;
      }
      // All in arrays that nothing else can be: loops over lanes. At the start
      // there was no step: as after an endless one the rate is 0.
      const double h = h_ > 0. ? h_ : std::numeric_limits<double>::infinity(),
                   kick = kick_, last_step = h_;
      double V[n], x[n], p[n], d[n], before[n], last[n], limit[n];
      for (unsigned int l = 0; l < n; ++l) {
        V[l] = volume[l];
        x[l] = now[l];
        p[l] = tension[first + l];
        d[l] = dilatation[first + l];
        before[l] = present_viscosity[first + l];
        last[l] = rate[first + l];
        limit[l] = viscosity[first + l];
      }
      double D[n], next[n], terms[4][n];
      for (unsigned int l = 0; l < n; ++l) {
        D[l] = (x[l] - d[l]) / h;
        before[l] = kick * before[l];
      }
      for (unsigned int l = 0; l < n; ++l) {
        const double ratio = last[l] / (D[l] != 0. ? D[l] : 1.);
        const double r = D[l] != 0. ? ratio : 0.;
        const double least = -before[l] / h * r * (2. + r);
        next[l] = limit[l] < least ? least : limit[l];
      }
      for (unsigned int l = 0; l < n; ++l) {
        const double sum = last[l] + D[l];
        terms[0][l] = V[l] * p[l] * D[l];
        terms[1][l] = V[l] * next[l] * D[l] * D[l];
        terms[2][l] = V[l] * next[l] * D[l] * x[l];
        terms[3][l] = V[l] / 4. *
                      (before[l] * sum * sum -
                       (before[l] - last_step * next[l]) * D[l] * D[l]);
        p[l] = next[l] * D[l];
      }
      for (unsigned int row = 0; row < 4; ++row)
        std::copy_n(terms[row], n, &terms_[row * eta_.size() + first]);
      std::copy_n(next, n, &present_viscosity[first]);
      std::copy_n(p, n, &tension[first]);
      std::copy_n(x, n, &dilatation[first]);
      std::copy_n(D, n, &rate[first]);
    }

    /** Tensions stay what they are: those of a checkpoint. */
    bool holds = false;

    /** Sums over the cells: of volume times tension times ..., in J or W. */
    struct Powers {
      double before = 0.; ///< tension of the forces before, rate of the step
      double after = 0.;  ///< of the present forces, rate of the step
      double stored = 0.; ///< of the present forces, dilatation
      double taken = 0.;  ///< what the step took, J
    };
    /** After all cells: those, and psi of the next forces. Collective. */
    Powers finish(const Communicator &communicator);

    /** Of @p first_dof: places in a vector over unknowns, four per cell. */
    void serialize(Archive &archive, const std::vector<std::size_t> &first_dof);

  private:
    void set_viscosity(std::size_t cell);

    bool acts_ = false;
    const GhostCells *ghosts_ = nullptr; ///< null: there are none
    std::vector<double> eta_;            ///< Pa s
    std::vector<std::size_t> first_neighbor_;
    std::vector<unsigned int> neighbor_;
    std::vector<double> weight_;     ///< beside it; empty: all cells are alike
    std::vector<unsigned int> ends_; ///< cells with one neighbour
    std::vector<double> terms_;
    double h_ = 0., kick_ = 0.;
  };
} // namespace nsfd
