#pragma once

#include <string>

namespace nsfd
{
  struct SolverInput {
    std::string method = "auto"; ///< auto | dual newton | gauss seidel
    std::string path = "auto";   ///< auto | local | assembled
    std::string linear_solver =
        "auto"; ///< of the assembled path: auto | direct | cg
    double tolerance = 1e-8;
    unsigned int maximum_iterations = 200;
    /// none | hard | all: steps whose contacts become stored problems
    std::string save_problems = "none";
  };
} // namespace nsfd
