#include "mesh/gmsh_process.h"

#include <deal.II/base/exceptions.h>
#include <deal.II/base/mpi.h>

#include <gtest/gtest.h>

int main(int argc, char **argv)
{
  // readers of meshes start this program again
  if (const auto code = nsfd::run_gmsh_if_asked(argc, argv))
    return *code;
  dealii::Utilities::MPI::MPI_InitFinalize mpi(argc, argv, 1);
  dealii::deal_II_exceptions::disable_abort_on_exception();
  testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}
