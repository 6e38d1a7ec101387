#include "crack_pressure.h"

#include "step_data.h"

#include "nsfd/scene/scene_input.h"
#include "state/state.h"

namespace nsfd
{
  template <int dim>
  std::unique_ptr<CrackPressure<dim>>
  CrackPressure<dim>::make(const SceneInput &input,
                           const Discretization<dim> &discretization)
  {
    return has_crack_pressure(input)
               ? std::make_unique<CrackPressure>(input, discretization)
               : nullptr;
  }

  template <int dim>
  CrackPressure<dim>::CrackPressure(const SceneInput &input,
                                    const Discretization<dim> &discretization)
      : input_(input), discretization_(discretization)
  {
  }

  template <int dim>
  void CrackPressure<dim>::evaluate(const State &old, const double time,
                                    std::vector<double> &pressure) const
  {
    const auto &origins = discretization_.origins();
    pressure.assign(origins.size(), 0.);
    for (std::size_t i = 0; i < origins.size(); ++i) {
      if (origins[i].kind != PointOrigin::Kind::interface)
        continue;
      const auto &block = input_.interfaces[origins[i].block];
      if (block.crack_pressure && old.beta[i] <= block.pressure_threshold)
        pressure[i] = block.crack_pressure->at(
            position_of(discretization_.points(), i), time);
    }
  }

  template <int dim>
  std::vector<double>
  CrackPressure<dim>::impulse(const std::vector<double> &pressure,
                              const double time_step) const
  {
    const auto &weight = discretization_.points().weight;
    std::vector<double> result(pressure.size() * dim, 0.);
    for (std::size_t i = 0; i < pressure.size(); ++i)
      result[i * dim] = weight[i] * time_step * pressure[i];
    return result;
  }

  template class CrackPressure<2>;
  template class CrackPressure<3>;
} // namespace nsfd
