#pragma once

#include "ghost_cells.h"

#include "core/communicator.h"
#include "core/instruction_sets.h"
#include "core/vector8.h"
#include "discretization/discretization.h"
#include "linear_algebra/block_kernels.h"

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
      update_block(cell, 1, now, volume);
    }

    /** The same of @p count cells one after the other, 8 at most, of Vector8: a
     * number of a cell does not depend on its place among them. */
    template <typename Number>
    NSFD_INLINE void update_block(const std::size_t first,
                                  const unsigned int count, const Number &now,
                                  const Number &volume)
    {
      if (holds) {
        put(now, count, &dilatation[first]);
        return;
      }
      // at the start there was no step: as after an endless one the rate is 0
      const double h = h_ > 0. ? h_ : std::numeric_limits<double>::infinity();
      Number p, d, before, last, next;
      get(&tension[first], count, p);
      get(&dilatation[first], count, d);
      get(&present_viscosity[first], count, before);
      get(&rate[first], count, last);
      get(&viscosity[first], count, next);
      const Number D = (now - d) / h, zero = {};
      before *= kick_;
      const Number r = D != 0. ? last / (D != 0. ? D : zero + 1.) : zero;
      const Number least = before / -h * r * (2. + r);
      next = next < least ? least : next;
      const Number sum = last + D;
      const std::size_t n = eta_.size();
      put(volume * p * D, count, &terms_[first]);
      put(volume * next * D * D, count, &terms_[n + first]);
      put(volume * next * D * now, count, &terms_[2 * n + first]);
      put(volume / 4. * (before * sum * sum - (before - h_ * next) * D * D),
          count, &terms_[3 * n + first]);
      put(next, count, &present_viscosity[first]);
      put(next * D, count, &tension[first]);
      put(now, count, &dilatation[first]);
      put(D, count, &rate[first]);
    }

    NSFD_INLINE static void get(const double *from, unsigned int, double &to)
    {
      to = *from;
    }
    /** @p count numbers, and zeros. */
    NSFD_INLINE static void get(const double *from, const unsigned int count,
                                Vector8 &to)
    {
      if (count == lanes) {
        to = *reinterpret_cast<const Vector8u *>(from);
        return;
      }
      to = Vector8{};
      for (unsigned int l = 0; l < count; ++l)
        to[l] = from[l];
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
    NSFD_INLINE static void put(const double from, unsigned int, double *to)
    {
      *to = from;
    }
    NSFD_INLINE static void put(const Vector8 &from, const unsigned int count,
                                double *to)
    {
      if (count == lanes) {
        *reinterpret_cast<Vector8u *>(to) = from;
        return;
      }
      for (unsigned int l = 0; l < count; ++l)
        to[l] = from[l];
    }
    void set_viscosity(std::size_t cell);
    /** Of neighbour @p k of a cell: those of `lanes` cells side by side. */
    std::size_t slot(const std::size_t cell, const unsigned int k) const
    {
      return (cell / lanes * n_slots_ + k) * lanes + cell % lanes;
    }

    bool acts_ = false;
    const GhostCells *ghosts_ = nullptr; ///< null: there are none
    std::vector<double> eta_;            ///< Pa s
    unsigned int n_slots_ = 0;           ///< the most neighbours of a cell
    std::vector<unsigned int> neighbor_; ///< see slot(); itself: none
    std::vector<double> weight_; ///< beside it; empty: all cells are alike
    std::vector<unsigned int> others_; ///< cells that have their own sums
    std::vector<unsigned int> ends_;   ///< cells with one neighbour
    std::vector<double> terms_;
    double h_ = 0., kick_ = 0.;
  };
} // namespace nsfd
