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
   * impulses with their velocities and error, factors, and the bill. */
  template <int d>
  struct Session {
    Session(const ContactProblem &stored, const double tolerance)
        : problem(stored), tolerance(tolerance), r(std::size_t(d) * problem.n),
          u(problem.q), error(problem.error(r.data(), u.data()))
    {
    }

    BlockProblem<d> problem;
    double tolerance;
    std::vector<double> r, u; ///< at first r = 0, u = q
    double error;
    unsigned int iterations = 0, products = 0, factorisations = 0;
    std::string finisher;
    std::vector<std::string> switches;

    bool solved() const { return error <= tolerance; }

    /** u and error of r. */
    void judge()
    {
      problem.velocity(r.data(), u.data());
      ++products;
      error = problem.error(r.data(), u.data());
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
      return factors().factor(A.data(), B.data());
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
      const double error_before = error;
      solver();
      if (!(error <= error_before)) {
        r = before;
        judge();
      }
    }

  private:
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
    /** Changes r only; u and error are those of before. */
    void run(unsigned int count);

  private:
    Session<d> &s_;
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
  };
  template <int d>
  bool newton(Session<d> &session, const NewtonSettings &settings);

  template <int d>
  bool proximal(Session<d> &session, unsigned int limit);

  template <int d>
  bool interior_point(Session<d> &session, unsigned int limit);

  template <int d>
  bool admm(Session<d> &session, unsigned int limit);

  template <int d>
  bool projected_gradient(Session<d> &session, unsigned int limit);

  template <int d>
  bool automatic(Session<d> &session);
} // namespace nsfd::stored
