#include "nsfd/verification/case_input.h"

#include "nsfd/core/archive.h"

#include <algorithm>

namespace nsfd
{
  using namespace cases;

  /**
   * Pressure p in an open crack across a bar of free ends, from t = 0: each
   * face carries the traction p and moves at p/Z, Z = rho c, away from the
   * other, until waves come back from the ends; the pressure has then done the
   * work 2 p^2 t/Z per area, all of it in waves of compression p.
   */
  class CrackPressureCase final : public VerificationCase
  {
  public:
    explicit CrackPressureCase(SectionReader &) {}

    void initialise(const SceneInput &input) override
    {
      bar_ = bar_of(input);
      for (const InterfaceInput &interface : input.interfaces)
        if (interface.crack_pressure && interface.has_broken)
          pressure_ = (*interface.crack_pressure)(0., 0., 0., 0.);
      demand(pressure_ > 0., "an Interface block with broken points and a "
                             "positive crack pressure is missing");
      middle_ = 0.5 * (input.mesh.lower[0] + input.mesh.upper[0]);
      area_ = cross_section(input, 0);
      demand(input.time.end <= extent(input, 0) / bar_.speed * (1. + 1e-9),
             "the solution is known until waves come back to the crack");
    }

    bool has_fields() const override { return true; }
    bool has_stress() const override { return true; }

    Vector displacement(const Vector &x, const double t) const override
    {
      return {{side(x) * pressure_ / bar_.impedance() *
                   positive_part(travelled(x, t)),
               0., 0.}};
    }
    Vector velocity(const Vector &x, const double t) const override
    {
      return {{side(x) * pressure_ / bar_.impedance() * passed(x, t), 0., 0.}};
    }
    std::array<double, 6> stress(const Vector &x, const double t) const override
    {
      return {{-pressure_ * passed(x, t)}};
    }

    bool wants_cells() const override { return true; }

    /** The crack pushes either half with p: its momentum is p t. */
    void observe(const StepView &view) override
    {
      double left = 0., right = 0.;
      for (const CellState &cell : *view.cells)
        (cell.centre[0] < middle_ ? left : right) +=
            bar_.density * cell.volume * cell.velocity[0];
      const double exact = pressure_ * view.time * area_;
      if (exact > 0.)
        momentum_ = std::max({momentum_, relative_error(left, -exact),
                              relative_error(right, exact)});
      work_ = view.row->energy.work;
      exact_work_ = 2. * pressure_ * exact / bar_.impedance();
    }

    void finish(std::map<std::string, double> &errors) const override
    {
      errors["momentum"] = momentum_;
      errors["work"] = relative_error(work_, exact_work_);
    }

    void serialize(Archive &archive) override
    {
      archive.numbers("found", momentum_, work_, exact_work_);
    }

  private:
    Bar bar_;
    double pressure_ = 0., middle_ = 0., area_ = 0.;
    double momentum_ = 0., work_ = 0., exact_work_ = 0.;

    double side(const Vector &x) const { return x[0] < middle_ ? -1. : 1.; }
    double travelled(const Vector &x, const double t) const
    {
      return t - std::abs(x[0] - middle_) / bar_.speed;
    }
    double passed(const Vector &x, const double t) const
    {
      return heaviside(travelled(x, t));
    }
  };

  NSFD_REGISTER(VerificationRegistry, CrackPressureCase, "crack pressure",
                "Pressure in a crack across a bar: fields, momentum, work");
} // namespace nsfd
