#include "nsfd/verification/case_input.h"

#include "nsfd/core/archive.h"

#include <algorithm>

namespace nsfd
{
  using namespace cases;

  /**
   * A body that moves freely with the velocity of a rigid motion, translation
   * plus (small) rotation: u = t v_0(x) for ever, without stress and without
   * jumps, with constant kinetic energy and momentum.
   */
  class RigidMotion final : public VerificationCase
  {
  public:
    explicit RigidMotion(SectionReader &) {}

    void initialise(const SceneInput &input) override
    {
      demand(input.materials.size() == 1, "the case needs one material");
      dimension_ = input.dimension;
      const MaterialInput &material = input.materials[0];
      young_ = material.rigid ? 0. : material.young;
      velocity_ = material.initial_velocity;
      displacement_ = material.initial_displacement;
      for (const InterfaceInput &interface : input.interfaces)
        if (interface.law_name == "elastic")
          stiffness_ = interface.normal_stiffness;
        else if (interface.law && !interface.law->extrinsic())
          stiffness_ = interface.law->normal_stiffness();
    }

    bool has_fields() const override { return true; }

    Vector displacement(const Vector &x, const double t) const override
    {
      const Vector v = velocity(x, t);
      Vector u{};
      for (unsigned int c = 0; c < dimension_; ++c)
        u[c] = displacement_[c](x[0], x[1], x[2]) + t * v[c];
      return u;
    }

    Vector velocity(const Vector &x, double) const override
    {
      Vector v{};
      for (unsigned int c = 0; c < dimension_; ++c)
        v[c] = velocity_[c](x[0], x[1], x[2]);
      return v;
    }

    bool wants_cells() const override { return true; }

    void observe(const StepView &view) override
    {
      const EnergyLines &energy = view.row->energy;
      Vector momentum{};
      for (unsigned int c = 0; c < dimension_; ++c)
        momentum[c] = mean(*view.cells, &CellState::velocity, c);
      if (view.row->step == 0) {
        initial_kinetic_ = energy.kinetic;
        initial_momentum_ = momentum;
        volume_ = 0.;
        for (const CellState &cell : *view.cells)
          volume_ += cell.volume;
      }
      kinetic_ =
          std::max(kinetic_, relative_error(energy.kinetic, initial_kinetic_));
      double change = 0., size = 0.;
      for (unsigned int c = 0; c < dimension_; ++c) {
        change += std::pow(momentum[c] - initial_momentum_[c], 2);
        size += std::pow(initial_momentum_[c], 2);
      }
      momentum_ = std::max(momentum_, std::sqrt(change / size));
      stored_ = std::max(stored_, energy.cohesive);
      for (const CellState &cell : *view.cells) {
        for (const double sigma : cell.stress)
          stress_ = std::max(stress_, std::abs(sigma));
        double u = 0.;
        for (const double value : cell.displacement)
          u += value * value;
        largest_ = std::max(largest_, std::sqrt(u));
      }
    }

    /** Stress over E u_max / (edge of a cube as large as the body). */
    void finish(std::map<std::string, double> &errors) const override
    {
      const double size = std::pow(volume_, 1. / dimension_);
      errors["kinetic"] = kinetic_;
      errors["momentum"] = momentum_;
      if (young_ > 0.)
        errors["stress"] = stress_ * size / (young_ * largest_);
      // the jump that stores as much over one section of the body
      if (stiffness_ > 0.)
        errors["jump"] =
            std::sqrt(2. * stored_ * size / (stiffness_ * volume_)) / largest_;
    }

    void serialize(Archive &archive) override
    {
      archive.numbers("found", volume_, largest_, initial_kinetic_, kinetic_,
                      momentum_, stress_, stored_, initial_momentum_[0],
                      initial_momentum_[1], initial_momentum_[2]);
    }

  private:
    unsigned int dimension_ = 2;
    std::array<Expression, 3> velocity_, displacement_;
    double young_ = 0., stiffness_ = 0., volume_ = 0., largest_ = 0.;
    double initial_kinetic_ = 0., kinetic_ = 0., momentum_ = 0., stress_ = 0.,
           stored_ = 0.;
    Vector initial_momentum_{};
  };

  NSFD_REGISTER(VerificationRegistry, RigidMotion, "rigid motion",
                "Free translation and small rotation: no stress, no jump, "
                "constant energy and momentum");
} // namespace nsfd
