#pragma once

#include <cstddef>
#include <limits>
#include <string>
#include <vector>

namespace nsfd
{
  /** How far a cone problem has to be solved, and how much it may cost. */
  struct SolverControl {
    double tolerance = 1e-8; ///< of the relative natural map, see natural_map.h
    /// Newton steps or 100 sweeps each; sweeps, or products with W, where W is
    /// assembled. 0: what the solver thinks reasonable
    unsigned int maximum_iterations = 0;
    unsigned int idle_rounds = 2; ///< line searches that did not halve the
                                  ///< error before the solve is given up
    /// what rows with a prescribed velocity may give or take by what is left of
    /// it, see RowWork, J: of bodies that share nodes
    double row_energy = std::numeric_limits<double>::infinity();
    /// what contacts that close may give by what the tolerance leaves, J
    double contact_energy = std::numeric_limits<double>::infinity();

    /// matrices of the bodies are those of this problem alone: no factor of
    /// them serves later ones
    bool bodies_change = false;

    /// of the cascade for problems whose W is assembled: the first one and
    /// restarts. In a run a step that is not solved has other cures.
    unsigned int attempts = 6;

    unsigned int iterations_or(const unsigned int own) const
    {
      return maximum_iterations > 0 ? maximum_iterations : own;
    }
  };

  /** How far a solve came, and what it has cost. */
  struct SolverReport {
    bool converged = false;
    /// of a step: nothing moves by more than a solution may be off
    bool rests = false;
    double residual = 0.; ///< relative natural map, see natural_map.h
    unsigned int newton = 0, krylov = 0, sweeps = 0, line_searches = 0;
    unsigned int law_calls = 0;  ///< sweeps of the point law over all points
    std::size_t worst_point = 0; ///< local index of the worst point
    double worst_error = 0.;     ///< its share, this rank
    std::vector<std::string> switches; ///< hand-overs between methods

    // of problems whose W is assembled
    std::string solver;          ///< the one that finished
    unsigned int iterations = 0; ///< of all solvers that took part
    unsigned int products = 0;   ///< with W, sweeps included
    unsigned int factorisations = 0;
    unsigned int attempts = 1;     ///< of the cascade, restarts included
    unsigned int best_attempt = 1; ///< the one that gave the answer
    /// largest -u_N / max |q|. The residual is relative to |r| as well: where
    /// no r is a solution it can be made small by large r, and only this tells.
    double penetration = 0.;

    /** The work of a further solve. */
    void add_work(const SolverReport &next)
    {
      newton += next.newton;
      krylov += next.krylov;
      sweeps += next.sweeps;
      line_searches += next.line_searches;
      switches.insert(switches.end(), next.switches.begin(),
                      next.switches.end());
    }

    /** Its work, and where it has come to. */
    void go_on_with(const SolverReport &next)
    {
      add_work(next);
      residual = next.residual;
      converged = next.converged;
    }
  };
} // namespace nsfd
