#pragma once

#include "heat_cells.h"

#include "core/neighbor_messages.h"
#include "state/state.h"

#include <array>
#include <utility>
#include <vector>

namespace nsfd
{
  /**
   * Heat between and in the cells of a rank,
   *
   *   rho c dT/dt = div(k grad T),   -k dT/dn = h (T_1 - T_2) at faces,
   *
   * h infinite where faces hold, with temperatures that are linear in each
   * cell. Faces of any h, from perfect to none, by the form of Juntunen and
   * Stenberg (2009): with q = {k dT/dn}, R = 1/h and the jump [T],
   *
   *   a(T, v) = (k grad T, grad v) + < -g/(R+g) (q_T [v] + q_v [T])
   *             + [T][v]/(R+g) - g R/(R+g) q_T q_v >,
   *
   * positive for 1/g at least the flux_bound of both cells, and what leaves
   * one of them enters the other to the last bit. Sides of the scene are
   * adiabatic, or have a flux q_g or a temperature T_g,
   *
   *   ... + < -q_T v - q_v (T - T_g) + (T - T_g) v / g >,
   *
   * with 1/g twice the bound, so that half of the form of a cell is left.
   */
  template <int dim>
  class HeatConduction
  {
  public:
    /** Collective. */
    HeatConduction(const Discretization<dim> &discretization,
                   const Communicator &communicator);

    const HeatCells<dim> &cells() const { return cells_; }
    /** Some material conducts. */
    bool conducts() const { return longest_step_ > 0.; }
    /** In which heat crosses a tenth of the smallest cell, s: no need to
        conduct more often. */
    double longest_step() const { return longest_step_; }

    /** K, by point: those of the sides in the ratio of warm(), in which bodies
        of two temperatures that meet have it. Collective. */
    std::vector<double> at_faces(const std::vector<double> &temperature);

    /** What the @p points have dissipated, J, goes to the corners of both
        sides: by their effusivity, or in halves where one does not conduct. */
    void warm(const std::vector<double> &points,
              std::vector<double> &temperature) const;

    struct Step {
      unsigned int iterations = 0;
      double given = 0.; ///< by sides of all ranks, J
    };
    /**
     * A step of @p length (s) by the backward Euler rule, at the faces and the
     * time of @p state. Collective. @throws std::runtime_error if there are too
     * many iterations.
     */
    Step conduct(double length, const State &state,
                 std::vector<double> &temperature);

  private:
    /** T and q of one side of a point, on the normal from side 1 to 2. */
    struct Trace {
      double value = 0., flux = 0.;
    };
    /** Where a point is on the surface of a cell of this rank. */
    struct Side {
      int cell = -1; ///< -1: none, or of another rank
      unsigned int slot = 0;
    };

    /** A slot of a face with a given flux or temperature. */
    struct Heated {
      Side side;
      unsigned int boundary = 0;
      double weight = 0., bound = 0.;
      dealii::Point<dim> place;
      double given = 0.; ///< W/m^2 or K, of the step
    };
    bool has_temperature(const Heated &slot) const;

    void find_sides();
    void find_heated();
    Trace trace_of(const Side &side, const double *x) const;
    void set_heated(const State &state);
    void exchange(std::vector<std::array<Trace, 2>> &traces, int tag);
    void find_bounds();
    double resistance(std::size_t point, const State &state) const;
    void set_faces(const State &state);
    void apply(double length, const std::vector<double> &x,
               std::vector<double> &y);
    std::vector<double> diagonal(double length) const;

    const Discretization<dim> &discretization_;
    const Communicator &communicator_;
    const HeatCells<dim> cells_;
    std::vector<std::array<Side, 2>> sides_; ///< by point
    /// point and side, cell by cell and slot by slot: what corners get is
    /// summed in this order, which ranks do not change
    std::vector<std::pair<unsigned int, unsigned int>> ends_;
    std::vector<double> bound_;   ///< 1/g of a point, W/(m^2 K); 0: no flux
    std::vector<double> share_1_; ///< of what a point dissipates
    double longest_step_ = 0.;
    /// of the form above, times w; of points that conduct
    struct Face {
      unsigned int point = 0;
      double mixed = 0., jump = 0., flux = 0.;
    };
    std::vector<Face> faces_;
    std::vector<int> face_of_; ///< by point, of `faces_`; -1: none
    std::vector<std::array<Trace, 2>> traces_; ///< by point
    std::vector<Heated> heated_;
    NeighborMessages<Trace> messages_;
  };
} // namespace nsfd
