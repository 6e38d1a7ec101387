#include "accelerated_rounds.h"

#include "stop_request.h"

#include <deal.II/base/index_set.h>
#include <deal.II/base/mpi.h>
#include <deal.II/lac/la_parallel_vector.h>
#include <deal.II/sundials/kinsol.h>

#include <algorithm>

namespace nsfd
{
  void
  accelerated_rounds(const Communicator &communicator, const unsigned int depth,
                     const unsigned int maximum, std::vector<double> &x,
                     const std::function<bool(std::vector<double> &)> &round)
  {
    using Distributed = dealii::LinearAlgebra::distributed::Vector<double>;
    using Kinsol = dealii::SUNDIALS::KINSOL<Distributed>;
    const dealii::IndexSet owned =
        dealii::Utilities::MPI::create_ascending_partitioning(
            communicator.mpi(), x.size())[communicator.rank()];
    // no length is small of itself: the rounds end where nothing changes
    Kinsol::AdditionalData data(Kinsol::AdditionalData::fixed_point,
                                maximum + 2, 1e-300, 1e-300);
    data.anderson_subspace_size = depth;
    Kinsol kinsol(data, communicator.mpi());
    kinsol.reinit_vector = [&](Distributed &v) {
      v.reinit(owned, communicator.mpi());
    };
    bool finished = false, stopped = false;
    unsigned int rounds = 0;
    kinsol.iteration_function = [&](const Distributed &in, Distributed &out) {
      if (finished) { // nothing changes: KINSOL stops
        out = in;
        return 0;
      }
      std::copy_n(in.begin(), x.size(), x.begin());
      try { // nothing leaves through C code
        finished = !round(x) || ++rounds == maximum;
      } catch (const StopRequested &) {
        stopped = true;
        return -1;
      }
      std::copy_n(x.begin(), x.size(), out.begin());
      return 0;
    };
    Distributed vector(owned, communicator.mpi());
    std::copy_n(x.begin(), x.size(), vector.begin());
    try {
      kinsol.solve(vector);
    } catch (const dealii::ExceptionBase &) {
      // judged by what the rounds reached
    }
    if (stopped)
      throw StopRequested();
    std::copy_n(vector.begin(), x.size(), x.begin());
  }
} // namespace nsfd
