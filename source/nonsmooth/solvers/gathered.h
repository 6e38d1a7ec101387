#pragma once

#include "nonsmooth/solver.h"

#include <memory>
#include <vector>

namespace nsfd
{
  /** What a rank has. */
  template <int dim>
  struct Part {
    Bodies bodies;
    InterfacePoints<dim> points;
  };

  /**
   * All bodies and points of a run on its first rank, for solvers whose factor
   * is serial. Their order is that of the keys of the faces: the same, and so
   * is every sum over them, on any number of ranks. Every member function is
   * called by all ranks, what it returns counts on the first one.
   */
  template <int dim>
  class Gathered
  {
  public:
    explicit Gathered(const DelassusOperator<dim> &delassus);

    /** The bodies of all ranks, on this one alone; null on the others. */
    DelassusOperator<dim> *delassus() const { return delassus_.get(); }

    /** The problem of all points. */
    OneStepProblem<dim> gather(const OneStepProblem<dim> &problem) const;

    /** Impulses of all points from those of the ranks. */
    std::vector<double> gather(const std::vector<double> &impulse) const;

    /** And back, to the points a rank shares too. */
    void scatter(const std::vector<double> &all,
                 std::vector<double> &impulse) const;

  private:
    template <typename T>
    void collect(const std::vector<T> &mine, std::size_t stride,
                 std::vector<T> &all) const;
    void build(const std::vector<std::vector<char>> &packages);
    void add_points(const std::vector<Part<dim>> &parts);
    void add_bodies(std::vector<Part<dim>> &parts);

    const Communicator &communicator_;
    std::size_t n_points_, n_owned_;
    StepTerms terms_;
    std::vector<unsigned int> place_; ///< of points rank by rank
    std::vector<std::vector<unsigned int>> points_of_; ///< per rank: into all
    Communicator alone_;
    Bodies bodies_;
    InterfacePoints<dim> points_;
    std::unique_ptr<DelassusOperator<dim>> delassus_;
  };

  /**
   * For solvers whose factor is serial: nothing if the error at @p impulse is
   * at most @p enough, else @p solve(problem, bodies, impulse, laws, report) at
   * it, on several ranks on the first one with the bodies of all, which @p
   * gathered keeps. Its answer and the counts of its report are those of every
   * rank; if they are to be @p the_same on any number of ranks, one alone puts
   * its bodies and points in that order as well. Collective.
   */
  template <int dim, typename Solve>
  SolverReport
  solve_on_one_rank(std::unique_ptr<Gathered<dim>> &gathered,
                    const OneStepProblem<dim> &problem,
                    DelassusOperator<dim> &delassus, const double energy_scale,
                    const SolverControl &control, const double enough,
                    std::vector<double> &impulse,
                    LawEvaluation<dim> &evaluation, const Solve &solve,
                    const bool the_same = false)
  {
    SolverReport report;
    evaluation.update(impulse);
    if (evaluation.error > enough) {
      if (delassus.communicator().size() == 1 && !the_same)
        solve(problem, delassus, impulse, evaluation, report);
      else {
        if (!gathered)
          gathered = std::make_unique<Gathered<dim>>(delassus);
        const auto whole = gathered->gather(problem);
        auto all = gathered->gather(impulse);
        if (auto *bodies = gathered->delassus()) {
          bodies->reinit(problem.time_step, delassus.bulk_theta());
          LawEvaluation<dim> laws(whole, *bodies, energy_scale,
                                  control.tolerance);
          laws.update(all);
          solve(whole, *bodies, all, laws, report);
        }
        unsigned int counts[2] = {report.newton, report.krylov};
        MPI_Bcast(counts, 2, MPI_UNSIGNED, 0, delassus.communicator().mpi());
        report.newton = counts[0];
        report.krylov = counts[1];
        gathered->scatter(all, impulse);
        evaluation.update(impulse);
      }
    }
    report.residual = evaluation.error;
    report.converged = evaluation.error <= control.tolerance;
    return report;
  }
} // namespace nsfd
