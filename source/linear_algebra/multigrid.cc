#include "multigrid.h"

#include <deal.II/lac/trilinos_precondition.h>

#include <Epetra_CrsMatrix.h>
#include <Epetra_Map.h>
#include <Epetra_MpiComm.h>
#include <Epetra_Vector.h>
#include <Teuchos_ParameterList.hpp>
#include <ml_MultiLevelPreconditioner.h>

namespace nsfd
{
  struct Multigrid::Library {
    std::unique_ptr<Epetra_MpiComm> communicator;
    std::unique_ptr<Epetra_Map> map;
    std::unique_ptr<Epetra_CrsMatrix> matrix;
    std::vector<double> modes; // ML keeps a pointer to them
    dealii::TrilinosWrappers::PreconditionAMG cycle;
  };

  Multigrid::Multigrid(const Communicator &communicator)
      : library_(std::make_unique<Library>()), communicator_(communicator)
  {
  }

  Multigrid::~Multigrid() = default;

  void Multigrid::set_matrix(const SparseRows &matrix)
  {
    library_ = std::make_unique<Library>();
    auto &lib = *library_;
    const int n = matrix.n_rows();
    lib.communicator = std::make_unique<Epetra_MpiComm>(communicator_.mpi());
    lib.map = std::make_unique<Epetra_Map>(-1LL, n, 0LL, *lib.communicator);
    std::vector<int> lengths(n);
    for (int i = 0; i < n; ++i)
      lengths[i] = matrix.start[i + 1] - matrix.start[i];
    lib.matrix = std::make_unique<Epetra_CrsMatrix>(Copy, *lib.map,
                                                    lengths.data(), true);
    std::vector<long long> columns;
    for (int i = 0; i < n; ++i) {
      columns.clear();
      for (int k = matrix.start[i]; k < matrix.start[i + 1]; ++k)
        columns.push_back(matrix.column[k] < n
                              ? matrix.first_row + matrix.column[k]
                              : matrix.ghosts[matrix.column[k] - n]);
      lib.matrix->InsertGlobalValues(matrix.first_row + i, lengths[i],
                                     matrix.value.data() + matrix.start[i],
                                     columns.data());
    }
    lib.matrix->FillComplete();
  }

  void Multigrid::build(const std::vector<std::vector<double>> &modes,
                        const unsigned int equations_per_node,
                        const Finest finest)
  {
    auto &lib = *library_;
    lib.modes.clear();
    for (const auto &mode : modes)
      lib.modes.insert(lib.modes.end(), mode.begin(), mode.end());
    Teuchos::ParameterList list;
    ML_Epetra::SetDefaults("SA", list);
    list.set("ML output", 0);
    list.set("aggregation: type", "Uncoupled");
    list.set("aggregation: threshold", 0.);
    list.set("smoother: type", "Chebyshev");
    list.set("smoother: sweeps", 2);
    if (finest == Finest::left)
      list.set("smoother: type (level 0)", "do-nothing");
    list.set("smoother: pre or post", "both");
    list.set("coarse: type", "Amesos-KLU");
    list.set("coarse: max size", 1000);
    list.set("PDE equations", int(equations_per_node));
    list.set("null space: type", "pre-computed");
    list.set("null space: dimension", int(modes.size()));
    list.set("null space: vectors", lib.modes.data());
    list.set("null space: add default vectors", false);
    lib.cycle.initialize(*lib.matrix, list);
  }

  void Multigrid::apply(const double *b, double *x)
  {
    auto &lib = *library_;
    const Epetra_Vector right(View, *lib.map, const_cast<double *>(b));
    Epetra_Vector result(View, *lib.map, x);
    lib.cycle.trilinos_operator().ApplyInverse(right, result);
  }
} // namespace nsfd
