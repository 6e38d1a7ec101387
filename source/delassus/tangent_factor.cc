#include "tangent_factor.h"

#include <algorithm>
#include <cmath>

namespace nsfd
{
  template <int dim>
  void TangentFactor<dim>::set_space(const CoarseSpace &space)
  {
    solver_.set_space(space);
    clear();
  }

  template <int dim>
  bool TangentFactor<dim>::may_keep(const std::vector<double> &springs) const
  {
    // Measured on a bar of hexes and a plate of grains that break: a point
    // that changes costs about an iteration, a factor some five of them.
    constexpr unsigned int few = 5;
    constexpr double same = 0.8, soft = 0.3;
    if (communicator_.any(springs.size() != springs_.size()))
      return false;
    unsigned int changed = 0;
    const auto &faces = delassus_.points().faces;
    for (std::size_t f = 0; f < faces.size(); ++f)
      for (std::size_t i = 0; i < faces[f].count; ++i) {
        const std::size_t first = (faces[f].first + i) * dim * dim;
        double size = 0., change = 0.;
        for (std::size_t k = first; k < first + dim * dim; ++k) {
          size = std::max({size, std::abs(springs[k]), std::abs(springs_[k])});
          change = std::max(change, std::abs(springs[k] - springs_[k]));
        }
        // beside what the bodies themselves resist with
        const std::size_t n = faces[f].count * dim;
        const double W = delassus_.face_block(f)[i * dim * (n + 1)];
        changed += change > same * size && change * W > soft;
      }
    return communicator_.sum_integer(changed) <= few;
  }

  template <int dim>
  bool TangentFactor<dim>::factor(const SparseRows &matrix,
                                  const std::vector<double> &springs)
  {
    clear();
    if (!solver_.try_to_prepare(matrix))
      return false;
    springs_ = springs;
    return true;
  }

  template class TangentFactor<2>;
  template class TangentFactor<3>;
} // namespace nsfd
