#include "nsfd/verification/case_input.h"

#include "nsfd/core/archive.h"

#include <algorithm>

namespace nsfd
{
  using namespace cases;

  /**
   * Block that starts from rest on an inclined plane: gravity has the parts
   * g_N into the plane and g_T along it. It sticks for mu g_N >= g_T and
   * slides with the acceleration g_T - mu g_N otherwise; the normal reaction
   * is m g_N in either case.
   */
  class Incline final : public VerificationCase
  {
  public:
    explicit Incline(SectionReader &) {}

    void initialise(const SceneInput &input) override
    {
      demand(input.obstacles.size() == 1, "the case needs one Obstacle");
      const ObstacleInput &plane = input.obstacles[0];
      up_ = direction_of(plane.normal);
      pull_ = input.gravity;
      normal_pull_ = -up_.sign * pull_[up_.axis];
      pull_[up_.axis] = 0.;
      tangential_pull_ = std::hypot(pull_[0], pull_[1], pull_[2]);
      demand(normal_pull_ > 0. && tangential_pull_ > 0.,
             "gravity must pull into the plane and along it");
      for (const MaterialInput &material : input.materials)
        for (unsigned int c = 0; c < input.dimension; ++c)
          demand(material.initial_velocity[c].is_zero(),
                 "the block must start from rest");
      acceleration_ =
          positive_part(tangential_pull_ - plane.friction * normal_pull_);
    }

    bool wants_cells() const override { return true; }

    void observe(const StepView &view) override
    {
      const double t = view.time, h = view.time_step;
      Vector v{}, u{};
      for (unsigned int c = 0; c < 3; ++c) {
        v[c] = mean(*view.cells, &CellState::velocity, c);
        u[c] = mean(*view.cells, &CellState::displacement, c);
      }
      if (view.row->step > 0) {
        double v_T = 0., u_T = 0.; // along the pull
        for (unsigned int c = 0; c < 3; ++c) {
          v_T += v[c] * pull_[c] / tangential_pull_;
          u_T += u[c] * pull_[c] / tangential_pull_;
        }
        velocity_ = std::max(velocity_, std::abs(v_T - acceleration_ * t) /
                                            (tangential_pull_ * t));
        position_ =
            std::max(position_, std::abs(u_T - 0.5 * acceleration_ * t * t) /
                                    (0.5 * tangential_pull_ * t * t));
        // m dv_N = (R_N - m g_N) h
        reaction_ = std::max(reaction_, std::abs(v[up_.axis] - old_normal_) /
                                            (normal_pull_ * h));
      }
      old_normal_ = v[up_.axis];
    }

    /** Largest of all steps, over what the pull does without friction. */
    void finish(std::map<std::string, double> &errors) const override
    {
      errors["velocity"] = velocity_;
      errors["position"] = position_;
      errors["normal_reaction"] = reaction_;
    }

    void serialize(Archive &archive) override
    {
      archive.numbers("found", velocity_, position_, reaction_, old_normal_);
    }

  private:
    Direction up_;
    Vector pull_{};
    double normal_pull_ = 0., tangential_pull_ = 0., acceleration_ = 0.;
    double velocity_ = 0., position_ = 0., reaction_ = 0., old_normal_ = 0.;
  };

  NSFD_REGISTER(VerificationRegistry, Incline, "incline",
                "Block on an inclined plane: stick or slide, normal reaction");
} // namespace nsfd
