#include "point_factors.h"

#include "discretization.h"
#include "nsfd/scene/scene_input.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>

namespace nsfd
{
  template <int dim>
  PointFactors point_factors(const InterfaceInput &block,
                             const double *position, const double extent)
  {
    std::array<double, 3> x{}, scaled{};
    for (unsigned int c = 0; c < dim; ++c) {
      x[c] = position[c];
      scaled[c] = position[c] / extent;
    }
    const auto factor = [&](const Expression &graded, const Scatter &scatter,
                            const ScatterOf what) {
      const double mean = graded(x[0], x[1], x[2]);
      return scatter.is_random()
                 ? mean *
                       scatter.factor(scatter_number(what, block.seed, scaled))
                 : mean;
    };
    return {factor(block.strength_factor, block.strength_scatter,
                   ScatterOf::strength),
            factor(block.toughness_factor, block.toughness_scatter,
                   ScatterOf::toughness)};
  }

  PointFactors warm_factors(const InterfaceInput &block, const double T)
  {
    return {block.heat.strength.at(T), block.heat.toughness.at(T)};
  }

  double friction_factor(const SceneInput &input, const PointOrigin &origin,
                         const double T)
  {
    switch (origin.kind) {
    case PointOrigin::Kind::interface:
      return input.interfaces[origin.block].heat.friction.at(T);
    case PointOrigin::Kind::obstacle:
      return input.obstacles[origin.block].friction_factor.at(T);
    default:
      return 1.;
    }
  }

  template <int dim>
  void check_point_factors(const SceneInput &input,
                           const Discretization<dim> &discretization,
                           const Communicator &communicator,
                           std::vector<std::string> &problems)
  {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    for (unsigned int b = 0; b < input.interfaces.size(); ++b) {
      const auto &block = input.interfaces[b];
      for (const auto &[name, expression] :
           {std::pair("strength factor", &block.strength_factor),
            std::pair("toughness factor", &block.toughness_factor)}) {
        if (expression->is_constant())
          continue; // checked by the reader
        double smallest = infinity;
        for (std::size_t i = 0; i < discretization.points().n_owned; ++i) {
          const PointOrigin origin = discretization.origins()[i];
          if (origin.kind != PointOrigin::Kind::interface || origin.block != b)
            continue;
          const double value =
              expression->at(position_of(discretization.points(), i));
          smallest =
              std::min(smallest, std::isfinite(value) ? value : -infinity);
        }
        smallest = communicator.min(smallest);
        if (!(smallest > 0.))
          problems.push_back(fmt::format(
              "Interface: {}/{} = {} must be positive, but {}", block.name,
              name, expression->text(),
              std::isinf(smallest)
                  ? "is not a number on a face of the block"
                  : fmt::format("falls to {:.4g} on its faces", smallest)));
      }
    }
  }

  template PointFactors point_factors<2>(const InterfaceInput &, const double *,
                                         double);
  template PointFactors point_factors<3>(const InterfaceInput &, const double *,
                                         double);
  template void check_point_factors(const SceneInput &,
                                    const Discretization<2> &,
                                    const Communicator &,
                                    std::vector<std::string> &);
  template void check_point_factors(const SceneInput &,
                                    const Discretization<3> &,
                                    const Communicator &,
                                    std::vector<std::string> &);
} // namespace nsfd
