#include "nsfd/verification/case_input.h"

#include "nsfd/core/archive.h"
#include "nsfd/parameters/section_reader.h"
#include "nsfd/postprocess/running_crack.h"

namespace nsfd
{
  using namespace cases;

  /**
   * Two arms of height H, apart over the length a, are pulled open at their
   * ends with the force P each until they rest. As beams that are clamped 0.677
   * H behind the tip, which is what two-dimensional elasticity adds for
   * isotropic arms (shear and root rotation),
   *
   *   G = P^2 a_e^2/(E' I),   C = 2 a_e^3/(3 E' I),   a_e = a + 0.677 H.
   *
   * Boundary blocks `upper` and `lower` carry the load as tractions; the
   * observables `upper` and `lower` are probes on them.
   */
  class Cantilevers final : public VerificationCase
  {
  public:
    explicit Cantilevers(SectionReader &reader)
        : name_(reader.word("observable", "tip", "of type energy release rate"))
    {
      length_ = reader.number("length", "", units::length, Range::positive(),
                              "of the arms, a");
    }

    void initialise(const SceneInput &input) override
    {
      demand_box(input);
      demand(input.dimension == 2 && !input.materials.front().rigid,
             "the arms are elastic and in the plane");
      const double height = extent(input, 1) / 2.;
      for (const BoundaryInput &boundary : input.boundaries)
        if (boundary.name == "upper" && boundary.has_traction)
          force_ = boundary.traction[1](0., 0., 0.) * height;
      demand(force_ > 0., "`Boundary: upper` carries no `traction y` > 0");
      const double stiffness =
          RunningCrack(input.materials.front(), input.plane_stress)
              .stiffness() *
          std::pow(height, 3) / 12.;
      const double effective = length_ + 0.677 * height;
      release_ = std::pow(force_ * effective, 2) / stiffness;
      compliance_ = 2. * std::pow(effective, 3) / (3. * stiffness);
    }

    void observe(const StepView &view) override
    {
      found_release_ = view.observed(name_, "G");
      contours_ = view.observed(name_, "spread");
      found_compliance_ = (view.observed("upper", "displacement_y") -
                           view.observed("lower", "displacement_y")) /
                          force_;
    }

    void finish(std::map<std::string, double> &errors) const override
    {
      errors["G"] = relative_error(found_release_, release_);
      errors["compliance"] = relative_error(found_compliance_, compliance_);
      errors["contours"] = contours_;
    }

    void serialize(Archive &archive) override
    {
      archive.numbers("found", found_release_, found_compliance_, contours_);
    }

  private:
    const std::string name_;
    double length_ = 0., force_ = 0., release_ = 0., compliance_ = 0.;
    double found_release_ = 0., found_compliance_ = 0., contours_ = 0.;
  };

  NSFD_REGISTER(VerificationRegistry, Cantilevers, "cantilevers",
                "Two arms pulled open at rest: energy release rate, compliance",
                "length = 100 mm");
} // namespace nsfd
