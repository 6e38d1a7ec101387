#pragma once

#include "block_lu.h"
#include "contact_solver.h"
#include "one_contact.h"

#include <cmath>
#include <limits>
#include <memory>

namespace nsfd::stored
{
  /** What all solvers of one problem share: the problem in blocks, the current
   * impulses with their velocities and error, the best ones so far, factors,
   * and the bill. */
  template <int d>
  struct Session {
    Session(const ContactProblem &stored, const double tolerance)
        : problem(stored), tolerance(tolerance), r(std::size_t(d) * problem.n),
          u(problem.q), error(problem.error(r.data(), u.data())), best_r(r),
          best_error(error)
    {
    }

    BlockProblem<d> problem;
    double tolerance;
    std::vector<double> r, u; ///< at first r = 0, u = q
    double error;
    std::vector<double> best_r; ///< with the smallest error of all judged
    double best_error;
    unsigned int iterations = 0, products = 0, factorisations = 0;
    double work = 0.; ///< see charge()
    std::string finisher;
    std::vector<std::string> switches;
    unsigned int attempts = 1, best_attempt = 1; ///< the first one and restarts

    bool solved() const { return error <= tolerance; }

    /** u and error of r. */
    void judge()
    {
      problem.velocity(r.data(), u.data());
      count_products(1);
      error = problem.error(r.data(), u.data());
      keep();
    }

    /** The current impulses, if they are the best so far. A converging solver
     * is not charged for it: what solves is not needed again. */
    void keep()
    {
      if (error < best_error && !solved()) {
        best_error = error;
        best_r = r;
      }
    }

    /** Back to the best impulses, where nothing has solved it. */
    void restore_best()
    {
      if (solved())
        return;
      if (error > best_error || std::isnan(error)) {
        r = best_r;
        judge();
      }
      finisher = best_finisher_;
    }

    /** What @p blocks products with or of blocks cost, in such products: 3 to
     * 4 ns each (measured), as is what every contact costs besides, times 4. */
    void charge(const double blocks) { work += blocks + 4. * problem.n; }

    void count_products(const unsigned int count)
    {
      products += count;
      work += count * (double(problem.column.size()) + 4. * problem.n);
    }

    BlockLU<d> &factors()
    {
      if (!factors_)
        factors_ = std::make_unique<BlockLU<d>>(problem);
      return *factors_;
    }
    bool factor(const std::vector<double> &A, const std::vector<double> &B)
    {
      ++factorisations;
      charge(factors().work());
      return factors().factor(A.data(), B.data());
    }
    /** @p x: right-hand side in, solution out. */
    void solve(std::vector<double> &x)
    {
      charge(2. * double(factors().n_factor_blocks()));
      factors().solve(x.data());
    }

    /** A solver of a chain, if it is still needed. What it leaves is never
     * worse than what it got. */
    template <typename Solver>
    void attempt(const std::string &name, const Solver &solver)
    {
      if (solved())
        return;
      if (!finisher.empty())
        switches.push_back(finisher + " -> " + name);
      finisher = name;
      const std::vector<double> before = r;
      const double error_before = error, best_before = best_error;
      solver();
      if (best_error < best_before)
        best_finisher_ = name;
      if (!(error <= error_before)) {
        r = before;
        judge();
      }
    }

    /** A further attempt, from the best impulses of those before; the answer
     * is the best of all. Not a hand-over: there may be hundreds. */
    template <typename Solver>
    void restart(const std::string &name, const Solver &solver)
    {
      finisher = name;
      const double best_before = best_error;
      ++attempts;
      solver();
      if (solved() || best_error < best_before) {
        best_finisher_ = name;
        best_attempt = attempts;
      }
      restore_best();
    }

  private:
    std::string best_finisher_;
    std::unique_ptr<BlockLU<d>> factors_;
  };

  /** The impulses with the smallest error of a solve that may get worse. */
  template <int d>
  class Best
  {
  public:
    explicit Best(Session<d> &session)
        : s_(session), r_(session.r), error_(session.error)
    {
    }

    /** @return whether the current error is less than @p factor times the
     * smallest before */
    bool keep(const double factor = 1.)
    {
      const bool progress = s_.error < factor * error_;
      if (s_.error < error_) {
        error_ = s_.error;
        r_ = s_.r;
      }
      return progress;
    }
    void restore()
    {
      if (!(s_.error <= error_)) {
        s_.r = r_;
        s_.judge();
      }
    }

  private:
    Session<d> &s_;
    std::vector<double> r_;
    double error_;
  };

  /** Nonlinear Gauss-Seidel with exact local solves. */
  template <int d>
  class Sweeps
  {
  public:
    explicit Sweeps(Session<d> &session);
    /** The contacts in this order; empty: as they are numbered. */
    void set_order(const std::vector<int> &order) { order_ = order; }
    /** Changes r only; u and error are those of before. */
    void run(unsigned int count);

  private:
    Session<d> &s_;
    std::vector<int> order_;
    std::vector<OneContact<d>> contacts_;
  };

  // Every solver starts from session.r with its u and error, and leaves them
  // together. @return whether it is solved

  template <int d>
  bool gauss_seidel(Session<d> &session, unsigned int limit);

  struct NewtonSettings {
    unsigned int limit = 50;
    double regularisation = 1e-10; ///< times the mean diagonal entry of W
    unsigned int idle = 6; ///< steps without a smaller error before it gives up
    /// of the error over the first one; beyond it the method has left the
    /// neighbourhood of its start for good
    double largest_growth = std::numeric_limits<double>::infinity();
    /// of the velocities in the map, one per contact, over the usual ones;
    /// empty: all 1
    std::vector<double> weights;
  };
  template <int d>
  bool newton(Session<d> &session, const NewtonSettings &settings);

  template <int d>
  bool proximal(Session<d> &session, unsigned int limit,
                const std::vector<double> &weights = {});

  template <int d>
  bool interior_point(Session<d> &session, unsigned int limit);

  template <int d>
  bool admm(Session<d> &session, unsigned int limit);

  template <int d>
  bool projected_gradient(Session<d> &session, unsigned int limit);

  /** @param attempts the first one and restarts from other places; their
   * number also ends with a budget of work, about 10 s of CPU */
  template <int d>
  bool automatic(Session<d> &session, unsigned int attempts);

  /** Further attempts of solvers that have failed: from other starts, in other
   * orders, with other weights, all by dice that always fall alike. */
  template <int d>
  bool restarts(Session<d> &session, unsigned int attempts, double budget);
} // namespace nsfd::stored
