#pragma once

#include "held_laws.h"

#include "core/communicator.h"
#include "delassus/velocity_solver.h"

#include <array>
#include <vector>

namespace nsfd
{
  /** What takes the place of the load time, which is an unknown. */
  struct PathControl {
    double start = 0.;       ///< load time of the last equilibrium, s
    double longest = 0.;     ///< increment of the load time, s
    double dissipation = 0.; ///< of the step, J
    /// neither joined faces nor the longest increment end the step
    bool alone = false;
  };

  /**
   * The points of a step along a path of equilibria. With every law held as a
   * spring the equilibrium moves along a line as the load time does, which two
   * equilibria of the same springs tell. On it the step ends at the first of
   *
   *   - the dissipation that the control asks for,
   *   - a point that comes to the peak or to the end of its law, or a joined
   *     face whose mean traction comes to its strength: tractions have kinks
   *     there, which are passed one by one;
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
             const InterfacePoints<dim> &points,
             const OneStepProblem<dim> &problem, LoadStepIterate<dim> &iterate,
             HeldLaws<dim> &laws, const StaticBonds<dim> *const bonds)
        : communicator_(communicator), points_(points), problem_(problem),
          iterate_(iterate), laws_(laws), bonds_(bonds)
    {
    }

    struct End {
      double load_time = 0.; ///< s
      bool found = false;    ///< or the springs dissipate more at any load
      bool at_longest = false;
      /// what ends it: a point of this rank, if one does by a kink of its law
      std::size_t point = none;
      static constexpr std::size_t none = std::size_t(-1);
    };

    /** Springs as the last equilibrium has left its points. A joint with a law
        that rows hold, and not common nodes, is none of them: the first of this
        rank, or End::none. */
    std::size_t start();
    /** Rounds have settled at the load time @p s: the second of two. */
    void observe(double s);

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
     * Springs closer to those of the laws than follow() leaves them: a step of
     * Newton in the damage of the points that grow, of which each changes the
     * force of its own spring, and in the load time, which @p end gives and
     * takes, @p longest (s) at most. @p support (N/m) are those of the points.
     * False, and nothing done, for laws of two damage scalars, or if it has no
     * solution. On one rank.
     */
    bool improve(VelocitySolver &nodes, const std::vector<double> &support,
                 double longest, End &end, std::vector<double> &damage) const;

    /** Joined faces that carry their strength at @p s open: false if there are
        none. Collective. */
    bool open(double s);
    /** Springs where points damage at @p s as if these dissipated
        @p dissipation together, each as much. Collective. */
    void guess(double s, double dissipation);

    /** What points have dissipated on the line at @p s, J: its sum, and how
        many points share it, (sum d)^2 / sum d^2. Collective. */
    struct Dissipated {
      double sum = 0., points = 0.;
    };
    Dissipated dissipated(double s) const;
    /** w G of a point with a law, the mean of all, J. Collective. */
    double toughness_of_point() const;
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
    double excess(const PathControl &control, double s,
                  std::size_t *point) const;
    std::vector<double> springs(const std::vector<double> &support) const;
    std::vector<std::size_t> growing() const;
    Vector slope_of_reach(std::size_t point, double s) const;
    Vector mean_of_face(std::size_t point,
                        const std::vector<double> &force) const;
    double share_of(std::size_t point, const Vector &force) const;

    const Communicator &communicator_;
    const InterfacePoints<dim> &points_;
    const OneStepProblem<dim> &problem_;
    LoadStepIterate<dim> &iterate_;
    HeldLaws<dim> &laws_;
    const StaticBonds<dim> *bonds_; ///< of bodies that share nodes, or null
    Sample last_, now_;
  };
} // namespace nsfd
