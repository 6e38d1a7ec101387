#include "verification/pulled_fibre.h"

#include "nsfd/core/archive.h"

namespace nsfd
{
  using namespace cases;

  /**
   * A fibre in a rigid matrix that holds it by a constant friction tau = mu p,
   * pulled by the displacement U of its end and let back. With A = w the
   * section and the perimeter 1 (per depth), the shear lag model has, at the
   * force F, the slip length l = F / tau and
   *
   *   u(x) = tau (l - x)^2 / (2 E w),   U = F^2 / (2 E w tau),
   *
   * a friction work of F U / 3 and as much elastic energy. On the way back from
   * (F_0, U_0) the fibre slips by twice the friction, F_0 - F =
   * 2 sqrt(E w tau (U_0 - U)): the force is 0 at U_0 / 2, where friction has
   * taken another quarter of its work.
   *
   * The strip is not a line: its shear adds tau w / (3 G) to U, which is
   * (8/3) (tau / sigma)^2 (E / 2G) of it, sigma the stress at the end.
   */
  class PullOut final : public VerificationCase
  {
  public:
    explicit PullOut(SectionReader &) {}

    void initialise(const SceneInput &input) override
    {
      const PulledFibre fibre(input);
      length_ = fibre.length;
      width_ = fibre.half_thickness;
      young_ = fibre.young;
      demand(input.obstacles.size() == 1, "the matrix must be one Obstacle");
      for (const BoundaryInput &boundary : input.boundaries) {
        if (boundary.displacement[0])
          end_ = *boundary.displacement[0];
        if (boundary.has_traction)
          friction_ = -input.obstacles[0].friction *
                      boundary.traction[1](0.5 * length_, width_, 0., 0.);
      }
      demand(input.boundaries.front().displacement[0].has_value(),
             "the first Boundary must move the end by `displacement x`");
      demand(friction_ > 0., "a boundary must press the fibre on the matrix");
    }

    bool wants_cells() const override { return true; }

    void observe(const StepView &view) override
    {
      const double U = -end_(0., 0., 0., view.time);
      if (view.row->step == 0)
        return; // at rest
      if (U > largest_) {
        largest_ = U;
        friction_work_ = view.row->energy.friction;
        compare_cells(*view.cells);
      }
      reaction_ = view.row->reactions.empty() ? 0. : -view.row->reactions[0];
      exact_ = force(U);
      force_ = std::max(force_, std::abs(reaction_ - exact_) / top_force());
      all_friction_work_ = view.row->energy.friction;
    }

    void finish(std::map<std::string, double> &errors) const override
    {
      const double F = top_force(), work = F * largest_ / 3.;
      const double back = 0.5 * (F - exact_) / friction_; // slip length
      errors["force"] = force_;
      errors["last_force"] = std::abs(reaction_ - exact_) / F;
      errors["displacement"] = cells_.displacement;
      errors["stress"] = cells_.stress;
      errors["friction_work"] = relative_error(friction_work_, work);
      errors["all_friction_work"] = relative_error(
          all_friction_work_, work + friction_ * friction_ * back * back *
                                         back / (3. * young_ * width_));
      errors["exact_force"] = F;
      errors["exact_slip_length"] = F / friction_;
    }

    void serialize(Archive &archive) override
    {
      archive.numbers("found", largest_, reaction_, exact_, force_,
                      friction_work_, all_friction_work_, cells_.displacement,
                      cells_.stress);
    }

  private:
    Expression end_;
    double length_ = 0., width_ = 0., young_ = 0., friction_ = 0.;
    double largest_ = 0., reaction_ = 0., exact_ = 0., force_ = 0.,
           friction_work_ = 0., all_friction_work_ = 0.;
    FibreErrors cells_;

    double top_force() const
    {
      return std::sqrt(2. * young_ * width_ * friction_ * largest_);
    }

    /** On the way to the largest displacement, or back from it. */
    double force(const double U) const
    {
      return top_force() - 2. * std::sqrt(young_ * width_ * friction_ *
                                          positive_part(largest_ - U));
    }

    void compare_cells(const std::vector<CellState> &cells)
    {
      const double slip = top_force() / friction_;
      cells_ = fibre_errors(
          cells,
          [&](const double x) {
            return 0.5 * friction_ * std::pow(positive_part(slip - x), 2) /
                   (young_ * width_);
          },
          [&](const double x) {
            return friction_ * positive_part(slip - x) / width_;
          });
    }
  };

  NSFD_REGISTER(VerificationRegistry, PullOut, "pull-out",
                "Fibre held by friction, pulled and let back: force, "
                "displacement, friction work");
} // namespace nsfd
