#include "verification/rigid_motion_input.h"

#include "nsfd/parameters/section_reader.h"

#include <algorithm>

namespace nsfd
{
  using namespace cases;

  /**
   * A row of n equal balls at rest; the first one moves towards them with v.
   *
   * If they touch, all contacts act at once. Newton's law says that the first
   * opens with e v and that the others, which were at rest, open with 0 at
   * least. All impulses push, so no other contact opens, and by the balance of
   * momentum the first ball leaves with (1 - (1 + e)(n - 1)/n) v and each of
   * the others with (1 + e)/n v.
   *
   * If they are apart, the impacts follow each other; with e = 1 the last ball
   * leaves with v and the others rest.
   */
  class Cradle final : public VerificationCase
  {
  public:
    explicit Cradle(SectionReader &reader)
        : apart_(reader.boolean("apart", false,
                                "true if the balls do not touch at the start"))
    {
    }

    void initialise(const SceneInput &input) override
    {
      demand_rigid(input);
      gyration_of_ball(input);
      demand(input.contacts.size() == 1, "the case needs one Contact");
      restitution_ = input.contacts[0].restitution;
      demand(!apart_ || restitution_ == 1.,
             "balls that are apart need restitution = 1");
    }

    void observe(const StepView &view) override
    {
      using namespace space;
      const auto &bodies = *view.rigid_bodies;
      demand(bodies.size() > 1, "the case needs several rigid bodies");
      if (view.row->step == 0) {
        start_ = bodies[0].velocity;
        demand(norm(start_) > 0., "the first ball must move");
      }
      const double n = double(bodies.size());
      Vec3 momentum{};
      velocity_ = squares_ = exact_squares_ = 0.;
      for (std::size_t k = 0; k < bodies.size(); ++k) {
        const double share = exact_share(k, n);
        velocity_ =
            std::max(velocity_,
                     norm(bodies[k].velocity - share * start_) / norm(start_));
        momentum = momentum + bodies[k].velocity;
        squares_ += dot(bodies[k].velocity, bodies[k].velocity);
        exact_squares_ += share * share * dot(start_, start_);
      }
      momentum_ = std::max(momentum_, norm(momentum - start_) / norm(start_));
    }

    /** Over the speed of the first ball, and over its energy. */
    void finish(std::map<std::string, double> &errors) const override
    {
      using namespace space;
      errors["velocity"] = velocity_;
      errors["energy"] =
          std::abs(squares_ - exact_squares_) / dot(start_, start_);
      errors["exact_energy"] = exact_squares_ / dot(start_, start_);
      errors["momentum"] = momentum_;
    }

    void serialize(Archive &archive) override
    {
      cases::serialize(archive, "start", start_);
      archive.numbers("found", velocity_, squares_, exact_squares_, momentum_);
    }

  private:
    bool apart_;
    double restitution_ = 0.;
    Vec3 start_{};
    double velocity_ = 0., squares_ = 0., exact_squares_ = 0., momentum_ = 0.;

    /** Velocity of ball @p k of @p n, over that of the first one before. */
    double exact_share(const std::size_t k, const double n) const
    {
      if (apart_)
        return double(k + 1) == n ? 1. : 0.;
      return k == 0 ? 1. - (1. + restitution_) * (n - 1.) / n
                    : (1. + restitution_) / n;
    }
  };

  NSFD_REGISTER(VerificationRegistry, Cradle, "cradle",
                "A ball hits a row of equal balls: velocities, energy");
} // namespace nsfd
