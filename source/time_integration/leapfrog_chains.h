#pragma once

#include "joined/joined_mesh.h"
#include "nonsmooth/point_law.h"

#include <cstdint>
#include <limits>
#include <vector>

namespace nsfd
{
  class Archive;
  struct State;

  /**
   * The points that take part in the steps of Leapfrog, by the order in which
   * they came. A law is taken over two steps, from u_{k-1} to u_{k+1}: the work
   * of the impulses with (v- + v+)/2 is then what is stored and dissipated
   * along it, to round-off, in steps of any length. Even and odd steps are two
   * chains; each has half of the weight, a history and a jump of its own.
   * `problem` has the one whose step is next; its jump_free is the jump of the
   * other one.
   */
  template <int dim>
  struct LeapfrogChains {
    /** @p mesh are the points of the mesh. */
    explicit LeapfrogChains(const OneStepProblem<dim> &mesh);

    std::size_t size() const { return point.size(); }

    /** Of the strength, and of openings: see OneStepProblem. */
    struct Factors {
      double strength = 1., opening = 1.;
    };

    /**
     * A point of the mesh becomes one of these, as @p state has it (both chains
     * alike); @p axes has the rows n, t1, t2.
     */
    void add(unsigned int mesh_point, const double *axes,
             const Factors &factors, const State &state);
    /** The same of one that was joined: held up to its strength. */
    void release(unsigned int mesh_point, const double *axes,
                 const Factors &factors);

    /** The axes of point @p a are others from now on: what it has stays where
        it is. Returns how much more energy it stores along them, J. */
    double turn(std::size_t a, const std::array<double, dim * dim> &axes);

    /** Point k is what @p order[k] has been. */
    void reorder(const std::vector<unsigned int> &order);

    /** The next step goes from u_k, over u_{k+1}. */
    void swap();

    /** Of the chain of the last step. @p place in @p state of the points of the
        mesh, or unsigned(-1); empty: that of the mesh. */
    void show(State &state, const std::vector<unsigned int> &place) const;
    /** What may be other than the mesh of a point says. */
    struct Others {
      bool frames = false; ///< in large motions
      /// of halves of faces that were released as one, or when they were warm
      bool factors = false;
    };
    /** The chain that is not shown, of points that have been added; @p n of the
        mesh. */
    void serialize(Archive &archive, std::size_t n, const Others &others);

    std::vector<unsigned int> point; ///< of the mesh
    OneStepProblem<dim> problem;
    struct Chain {
      std::vector<PointKind> kind;
      std::vector<double> opening_max, slip_max, compression, beta;
    } other;
    std::vector<double> beta;  ///< of the chain in `problem`
    std::vector<double> frame; ///< rows n, t1, t2
    /// U after the step that is tried, and before it
    std::vector<double> velocity, old_velocity;
    std::vector<double> impulse, slip;
    std::vector<double> released; ///< overlap where contact holds, m
    /// `released` of a point whose contact is left to the search
    static constexpr double left = std::numeric_limits<double>::infinity();
    bool is_left(const std::size_t a) const { return released[a] == left; }
    bool is_broken(const std::size_t a) const
    {
      return problem.kind[a] == PointKind::free &&
             other.kind[a] == PointKind::free;
    }
    std::vector<std::uint8_t> closed, turned; ///< friction opposes the mean
    std::vector<LocalSolution<dim>> solution;

  private:
    void append(unsigned int mesh_point, const double *axes,
                const Factors &factors);

    const OneStepProblem<dim> &mesh_;
    bool has_slips_ = false; ///< there are laws with two damage scalars
  };
} // namespace nsfd
