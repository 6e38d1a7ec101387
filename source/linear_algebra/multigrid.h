#pragma once

#include "spd_solver.h"

#include <memory>

namespace nsfd
{
  /** One V-cycle of smoothed aggregation (ML of Trilinos). */
  class Multigrid
  {
  public:
    explicit Multigrid(const Communicator &communicator);
    ~Multigrid();

    /// who smooths on the finest level: without, a cycle is the correction of
    /// the coarser ones alone
    enum class Finest { smoothed, left };

    /** A copy of it: it need not stay. */
    void set_matrix(const SparseRows &matrix);
    /** Of that matrix; @p modes: the near null space, one value per own row
        each. */
    void build(const std::vector<std::vector<double>> &modes,
               unsigned int equations_per_node,
               Finest finest = Finest::smoothed);
    void apply(const double *b, double *x);

  private:
    struct Library;
    std::unique_ptr<Library> library_;
    const Communicator &communicator_;
  };
} // namespace nsfd
