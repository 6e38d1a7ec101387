#pragma once

#include "make_scene.h"

#include "discretization/cells.h"

#include <array>
#include <string>
#include <utility>
#include <vector>

namespace nsfd::test
{
  /** A scene of any scheme, step by step; explicit ones are begun as a run
      begins them. */
  template <int dim>
  class Steps : public Scene<dim>
  {
  public:
    explicit Steps(const std::string &text,
                   const std::vector<std::string> &overrides = {})
        : Scene<dim>(text, overrides)
    {
      if (!this->leapfrog)
        return;
      this->state = this->leapfrog->start_from(this->state);
      this->next = this->state;
    }

    StepReport step(const double share = 1.)
    {
      if (!this->leapfrog)
        return this->advance(share * this->time_step);
      const StepReport report = this->leapfrog->advance(
          this->state, share * this->time_step, this->next, 2);
      std::swap(this->state, this->next);
      return report;
    }

    /** The fields of the state, which explicit steps keep by nodes. */
    void show()
    {
      if (this->leapfrog)
        this->leapfrog->show(this->state);
    }

    std::array<double, dim> momentum()
    {
      show();
      std::array<double, dim> sum{};
      const auto &cells = this->discretization->cells();
      for (std::size_t b = 0; b < cells.bodies.size(); ++b) {
        const std::size_t first = cells.bodies.first_dof[b];
        for (unsigned int j = 0; j < cells.body_class(b).n_dofs; ++j)
          sum[j % dim] += lumped_mass(*cells.shape(b), j / dim) *
                          this->state.velocity[first + j];
      }
      return sum;
    }
  };
} // namespace nsfd::test
