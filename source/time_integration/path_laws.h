#pragma once

#include "held_laws.h"

#include "core/communicator.h"

#include <array>
#include <vector>

namespace nsfd
{
  /** What takes the place of the load time, which is an unknown. */
  struct PathControl {
    double start = 0.;       ///< load time of the last equilibrium, s
    double longest = 0.;     ///< increment of the load time, s
    double dissipation = 0.; ///< of the step, J
  };

  /**
   * The points of a step along a path of equilibria. With every law held as a
   * spring the equilibrium moves along a line as the load time does, which two
   * equilibria of the same springs tell. On it the step ends at the first of
   *
   *   - the dissipation that the control asks for,
   *   - a point that comes to the peak or to the end of its law, or, if it is
   *     joined, to its strength: tractions have kinks there, and points pass
   *     them one by one;
   *   - the longest increment of the load time.
   *
   * The springs are those of the laws once the points are as far open on the
   * line as the springs are damaged.
   */
  template <int dim>
  class PathLaws
  {
  public:
    /** All are those of the rounds and outlive this; @p bonds or null. */
    PathLaws(const Communicator &communicator,
             const OneStepProblem<dim> &problem, LoadStepIterate<dim> &iterate,
             HeldLaws<dim> &laws, const StaticBonds<dim> *const bonds)
        : communicator_(communicator), problem_(problem), iterate_(iterate),
          laws_(laws), bonds_(bonds)
    {
    }

    /** Springs as the last equilibrium has left its points. */
    void start();
    /** Rounds have settled at the load time @p s: the second of two. */
    void observe(double s);

    struct End {
      double load_time = 0.; ///< s
      bool found = false;    ///< or the springs dissipate more at any load
      bool at_longest = false;
    };
    /** Where the step ends on the present line. Collective. */
    End end(const PathControl &control) const;

    /** Damage of the springs over G/R_max, two numbers per point. */
    std::vector<double> damage() const;
    void set_damage(const std::vector<double> &damage);
    /**
     * The same as points are open at the load time @p s of the line; returns
     * the largest change of those that grow, of themselves. Points that were
     * opened and close again are joined. Collective.
     */
    double follow(double s, std::vector<double> &damage);

    /**
     * Joined points that carry their strength at @p s open, as springs that
     * have dissipated @p dissipation together. Collective.
     */
    bool open(double s, double dissipation);

    /** What points have dissipated on the line at @p s, J: its sum, and how
        many points share it, (sum d)^2 / sum d^2. Collective. */
    struct Dissipated {
      double sum = 0., points = 0.;
    };
    Dissipated dissipated(double s) const;
    /** w G of a point with a law, the mean of all, J. Collective. */
    double toughness_of_point() const;
    /** A point that the path cannot open, or none of this rank. */
    std::size_t point_held_by_rows() const;

    /** Laws again; the last round counts as one of theirs. */
    void conclude();

  private:
    using Vector = std::array<double, dim>;
    struct Sample {
      double load_time = 0.;
      std::vector<double> jump, force; ///< dim per point, m and N
    };
    bool takes_part(std::size_t point) const;
    bool is_closed(std::size_t point) const;
    Vector on_line(std::vector<double> Sample::*member, std::size_t point,
                   double s) const;
    double dissipation_of(std::size_t point, double s) const;
    double share(std::size_t point, double s) const;
    double event(std::size_t point, double s) const;
    double excess(const PathControl &control, double s) const;

    const Communicator &communicator_;
    const OneStepProblem<dim> &problem_;
    LoadStepIterate<dim> &iterate_;
    HeldLaws<dim> &laws_;
    const StaticBonds<dim> *bonds_; ///< of bodies that share nodes, or null
    Sample last_, now_;
  };
} // namespace nsfd
