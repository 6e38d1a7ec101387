#pragma once

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

namespace nsfd
{
  /** Where the time of a run goes. Every moment belongs to one line. */
  enum class Cost : unsigned int {
    rest,
    set_up,
    blocks,          ///< factors and products of body blocks
    free_motion,     ///< data of the step, loads, v_free
    solver,          ///< vectors of the Newton and Krylov loops
    laws,            ///< local problems of all points
    delassus,        ///< applications of W
    preconditioner,  ///< its set-up
    precondition,    ///< its applications
    sums,            ///< reductions over points and ranks
    sweeps,          ///< of Gauss-Seidel
    update,          ///< of the bodies
    energy_balance,  ///< energies and history
    output,          ///< files, pictures, comparison with exact values
    delassus_single, ///< applications of W in single precision
    messages,        ///< waiting for other ranks
    fragments,       ///< their masses, motions and sizes
    heat,            ///< temperatures
    count
  };

  /**
   * Charges the time of a scope to a line, and to no other: a scope inside
   * stops the line outside. Two readings of a monotonic clock, some 0.1 us.
   */
  class Charge
  {
  public:
    explicit Charge(Cost line);
    ~Charge();
    Charge(const Charge &) = delete;
    Charge &operator=(const Charge &) = delete;

  private:
    Cost outside_;
  };

  /** As it is printed. */
  const char *cost_name(Cost line);

  /** From now on all time is counted, from zero. */
  void begin_costs();

  struct TimePassed {
    double wall = 0., cpu = 0.; ///< s
  };
  /** Since begin_costs(). */
  TimePassed passed_since_begin();

  struct CostLine {
    std::string name;
    double seconds = 0.;
    unsigned long long calls = 0;
  };

  /**
   * All lines that were charged since begin_costs(), in the order of Cost.
   * Seconds are CPU time: the share of each line in the time that has passed,
   * of the CPU time of the process since then.
   */
  std::vector<CostLine> cost_lines();

  /**
   * The growth of the heap since the last call belongs to @p owner. What was
   * freed in between is not counted.
   */
  void charge_memory(const std::string &owner);

  /** Owners in the order of their first charge, and bytes. */
  const std::vector<std::pair<std::string, double>> &memory_lines();
} // namespace nsfd
