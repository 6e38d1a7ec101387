#include "block_inverse.h"

#include <cmath>

namespace nsfd
{
  namespace
  {
    constexpr double digits_of_mass = 1e12; // of the 16 that a double has
  }

  BlockInverse::BlockInverse(const BodyClass &body, const StepShares &shares)
  {
    const unsigned int n = body.n_dofs;
    Block A = body.mass;
    if (!body.rigid) {
      const double f = shares.stiffness;
      for (std::size_t i = 0; i < A.values.size(); ++i)
        A.values[i] += f * body.stiffness.values[i];
      for (std::size_t i = 0; i < body.damping.values.size(); ++i)
        A.values[i] += shares.damping * body.damping.values[i];
      const Block &R = body.rigid_motions;
      const Block momenta = product(body.mass, R);
      double of_strains = 0., of_motions = 0.;
      for (unsigned int i = 0; i < n; ++i) {
        of_strains += f * body.stiffness(i, i);
        if (body.damping.rows > 0)
          of_strains += shares.damping * body.damping(i, i);
        for (unsigned int k = 0; k < R.cols; ++k)
          of_motions += momenta(i, k) * momenta(i, k);
      }
      const double s = of_strains / of_motions;
      if (s < digits_of_mass) {
        factor_ = cholesky(A);
        return;
      }
      for (unsigned int k = 0; k < R.cols; ++k)
        for (unsigned int j = 0; j < n; ++j)
          for (unsigned int i = 0; i < n; ++i)
            A(i, j) += s * momenta(i, k) * momenta(j, k);
      rigid_ = R.transposed();
      for (double &value : rigid_.values)
        value *= std::sqrt(s / (1. + s));
    }
    factor_ = cholesky(A);
  }

  Block BlockInverse::form(const Block &B) const
  {
    const Block of_factor = forward_solve(factor_, B);
    if (rigid_.rows == 0)
      return gram(of_factor);
    const Block of_motions = product(rigid_, B);
    Block both(of_factor.rows + of_motions.rows, B.cols);
    for (unsigned int j = 0; j < B.cols; ++j) {
      for (unsigned int i = 0; i < of_factor.rows; ++i)
        both(i, j) = of_factor(i, j);
      for (unsigned int i = 0; i < of_motions.rows; ++i)
        both(of_factor.rows + i, j) = of_motions(i, j);
    }
    return gram(both);
  }
} // namespace nsfd
