#pragma once

#include "heat_conduction.h"

#include <functional>
#include <map>
#include <string>

namespace nsfd
{
  /** As the materials say, K, by corner of the cells. */
  template <int dim>
  std::vector<double>
  initial_temperatures(const Discretization<dim> &discretization);

  /**
   * The temperatures of the bodies from step to step: what friction, damage and
   * flow have taken warms the cells where it was taken, at once; it is
   * conducted whenever heat has had the time to cross a tenth of a cell. The
   * sum of both is of first order in that time.
   */
  template <int dim>
  class BodyHeat
  {
  public:
    /** Collective. */
    BodyHeat(const Discretization<dim> &discretization,
             const Communicator &communicator);

    /** As the materials say, at t = 0. Collective. */
    void start(State &state);

    /**
     * The step to @p state was taken, which has what it has dissipated.
     * @p show brings its points up to date. Collective. @throws
     * std::runtime_error, see HeatConduction.
     */
    void accept(State &state, const std::function<void()> &show);

    /** Iterations of this process, and how many cells heat has crossed in
        @p time (s), sqrt(kappa t) / l. */
    void fill_counters(double time,
                       std::map<std::string, double> &counters) const;

  private:
    void measure(State &state, double made) const;
    void set_faces(State &state);

    const Discretization<dim> &discretization_;
    const Communicator &communicator_;
    HeatConduction<dim> conduction_;
    const std::vector<double> at_start_; ///< K, by corner
    const bool laws_;                    ///< or friction depend on temperature
    unsigned long long iterations_ = 0;
  };
} // namespace nsfd
