#include "nsfd/verification/case_input.h"

#include "nsfd/core/archive.h"

#include <algorithm>

namespace nsfd
{
  using namespace cases;

  /**
   * Block that leaves a cohesive interface of area A and toughness G with the
   * speed v_0 along an axis. It separates for v_0 > sqrt(2 A G / m), and its
   * final speed is then sqrt(v_0^2 - 2 A G / m), whatever the shape of the
   * law. Everything that does not move at the start is fixed.
   */
  class Escape final : public VerificationCase
  {
  public:
    explicit Escape(SectionReader &) {}

    void initialise(const SceneInput &input) override
    {
      demand_box(input);
      bool moves = false;
      for (const MaterialInput &material : input.materials)
        for (unsigned int d = 0; d < input.dimension; ++d)
          moves |= !material.initial_velocity[d].is_zero();
      demand(moves, "a block must have an initial velocity");
      toughness_ = cohesive_interface(input).law->toughness();
      for (unsigned int d = 0; d < input.dimension; ++d)
        sections_[d] = cross_section(input, d);
    }

    bool wants_cells() const override { return true; }

    void observe(const StepView &view) override
    {
      const auto &cells = *view.cells;
      if (view.row->step == 0) {
        for (std::size_t i = 0; i < cells.size(); ++i)
          for (unsigned int d = 0; d < 3; ++d)
            if (std::abs(cells[i].velocity[d]) > std::abs(start_)) {
              start_ = cells[i].velocity[d];
              block_ = i;
              axis_ = d;
            }
        // the moving mass from its kinetic energy
        const double energy_2 = 2. * view.row->energy.kinetic;
        square_ = start_ * start_ *
                  (1. - 2. * sections_[axis_] * toughness_ / energy_2);
      }
      velocity_ = cells[block_].velocity[axis_];
      broken_ = view.row->broken_area / sections_[axis_];
    }

    void finish(std::map<std::string, double> &errors) const override
    {
      const bool escapes = broken_ > 1. - 1e-9;
      errors["escaped"] = escapes == (square_ > 0.) ? 0. : 1.;
      if (square_ > 0.)
        errors["final_speed"] = relative_error(
            velocity_, std::copysign(std::sqrt(square_), start_));
    }

    void serialize(Archive &archive) override
    {
      archive.numbers("found", block_, axis_, start_, square_, velocity_,
                      broken_);
    }

  private:
    double toughness_ = 0.;
    std::array<double, 3> sections_{};
    std::size_t block_ = 0;
    unsigned int axis_ = 0;
    double start_ = 0., square_ = 0., velocity_ = 0., broken_ = 0.;
  };

  NSFD_REGISTER(VerificationRegistry, Escape, "escape",
                "Block leaves a cohesive well: its final speed");
} // namespace nsfd
