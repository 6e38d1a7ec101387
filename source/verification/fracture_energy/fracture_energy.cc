#include "nsfd/verification/case_input.h"

#include "nsfd/core/archive.h"

#include <algorithm>

namespace nsfd
{
  using namespace cases;

  /**
   * What breaking a body takes, over the toughness times its section across x
   * (report, 3.3, table 1): the energy dissipated by damage, with friction, and
   * the external work; besides them the largest mean stress that its right side
   * carries. No exact value: the crack is free to choose its way.
   */
  class FractureEnergy final : public VerificationCase
  {
  public:
    explicit FractureEnergy(SectionReader &) {}

    void initialise(const SceneInput &input) override
    {
      demand_box(input);
      section_ = cross_section(input, 0);
      scale_ = cohesive_interface(input).law->toughness() * section_;
      demand(std::isfinite(scale_), "the law needs a finite toughness");
      unsigned int driven = 0;
      for (const BoundaryInput &boundary : input.boundaries) {
        bool moves = false;
        for (unsigned int c = 0; c < input.dimension; ++c)
          moves = moves || boundary.velocity[c] || boundary.displacement[c];
        if (!moves)
          continue;
        if (boundary.where.kind == Where::Kind::side &&
            boundary.where.name == "right")
          reaction_ = int(driven * input.dimension);
        ++driven;
      }
      demand(reaction_ >= 0, "the right side must be moved");
    }

    void observe(const StepView &view) override
    {
      const EnergyLines &energy = view.row->energy;
      damage_ = energy.damage;
      friction_ = energy.friction;
      work_ = energy.work;
      if (view.row->reactions.size() > std::size_t(reaction_))
        force_ = std::max(force_, view.row->reactions[reaction_]);
    }

    void finish(std::map<std::string, double> &errors) const override
    {
      errors["damage_energy"] = damage_ / scale_;
      errors["fracture_energy"] = (damage_ + friction_) / scale_;
      errors["external_work"] = work_ / scale_;
      errors["peak_stress"] = force_ / section_;
    }

    void serialize(Archive &archive) override
    {
      archive.numbers("found", damage_, friction_, work_, force_);
    }

  private:
    double section_ = 0., scale_ = 1., damage_ = 0., friction_ = 0., work_ = 0.,
           force_ = 0.;
    int reaction_ = -1;
  };

  NSFD_REGISTER(VerificationRegistry, FractureEnergy, "fracture energy",
                "What breaking a body takes: dissipated energy, work, peak "
                "stress");
} // namespace nsfd
