#include "nsfd/verification/case_input.h"

#include "nsfd/core/archive.h"

#include <cmath>

namespace nsfd
{
  using namespace cases;

  /**
   * Elastic bar held at one end, with a unilateral stop at the other, of the
   * kind used by Dabaghi, Petrov, Pousin and Renard (ESAIM: M2AN 48, 2014). It
   * is compressed linearly, its end at a from the stop, and let go. With x the
   * share of the length from the stop and t in units of L/c, within one period
   * of 3:
   *
   *   t < 1      u = a min(1 - x, 1 - t), not yet in contact,
   *   1 < t < 2  contact under the pressure E a / L,
   *              u = -a min(x, 1 - x, t - 1)   until t = 3/2,
   *
   * and u(x, 3 - t) = u(x, t). No energy is lost.
   */
  class StringStop final : public VerificationCase
  {
  public:
    explicit StringStop(SectionReader &) {}

    void initialise(const SceneInput &input) override
    {
      bar_ = bar_of(input);
      demand(input.obstacles.size() == 1, "the case needs one Obstacle");
      const ObstacleInput &stop = input.obstacles[0];
      normal_ = direction_of(stop.normal);
      const unsigned int d = normal_.axis;
      front_ = (normal_.sign > 0. ? input.mesh.lower : input.mesh.upper)[d];
      length_ = extent(input, d);
      unit_ = length_ / bar_.speed;
      mass_ = bar_.density * length_ * cross_section(input, d);
      demand(std::abs(front_ - stop.point[d]) < 1e-12 * length_,
             "the bar without stress must touch the stop");
      std::array<double, 3> x{};
      for (unsigned int e = 0; e < input.dimension; ++e)
        x[e] = input.mesh.lower[e];
      const auto stretch = [&](const double share) {
        x[d] = front_ + normal_.sign * share * length_;
        return normal_.sign *
               input.materials[0].initial_displacement[d](x[0], x[1], x[2]);
      };
      amplitude_ = stretch(0.);
      demand(amplitude_ > 0. && std::abs(stretch(1.)) < 1e-9 * amplitude_ &&
                 std::abs(stretch(0.5) / amplitude_ - 0.5) < 1e-9,
             "the initial displacement must fall linearly from the stop to "
             "the other end");
      unsigned int n_driven = 0;
      for (const BoundaryInput &boundary : input.boundaries)
        for (unsigned int c = 0; c < input.dimension; ++c)
          if (boundary.velocity[c] || boundary.displacement[c]) {
            ++n_driven;
            break;
          }
      demand(n_driven == 1, "one end must be held");
      reaction_ = d;
    }

    bool has_fields() const override { return true; }
    bool has_stress() const override { return true; }

    Vector displacement(const Vector &x, const double t) const override
    {
      const double s = share(x), p = phase(t), r = std::min(p, 3. - p);
      return along(amplitude_ * (r < 1. ? std::min(1. - s, 1. - r)
                                        : -std::min({s, 1. - s, r - 1.})));
    }

    Vector velocity(const Vector &x, const double t) const override
    {
      const double s = share(x), p = phase(t), r = std::min(p, 3. - p);
      const bool moves = r < 1. ? s < r : std::min(s, 1. - s) > r - 1.;
      const double speed = moves ? amplitude_ / unit_ : 0.;
      return along(p < 1.5 ? -speed : speed);
    }

    std::array<double, 6> stress(const Vector &x, const double t) const override
    {
      const double s = share(x), p = phase(t), r = std::min(p, 3. - p);
      const double strain = amplitude_ / length_;
      std::array<double, 6> sigma{};
      double &value = sigma[normal_.axis];
      if (r < 1.)
        value = s < r ? 0. : -bar_.young * strain;
      else if (std::min(s, 1. - s) < r - 1.)
        value = (s < 0.5 ? -1. : 1.) * bar_.young * strain;
      return sigma;
    }

    bool wants_cells() const override { return true; }

    /** The stop, from the momentum of the bar and the pull on its held end. */
    void observe(const StepView &view) override
    {
      const double momentum =
          normal_.sign * mass_ *
          mean(*view.cells, &CellState::velocity, normal_.axis);
      energy_ = mechanical_energy(*view.row);
      if (view.row->step == 0)
        initial_energy_ = energy_;
      else {
        const double h = view.time_step;
        const double push = momentum - momentum_ -
                            h * normal_.sign * view.row->reactions[reaction_];
        impulse_ += push;
        if (push > 0.5 * h * force())
          duration_ += h;
      }
      momentum_ = momentum;
      time_ = view.time;
    }

    /** Of all contacts so far. */
    void finish(std::map<std::string, double> &errors) const override
    {
      const double periods = std::floor(time_ / (3. * unit_));
      const double contacts = periods + std::clamp(phase(time_) - 1., 0., 1.);
      if (contacts > 0.) {
        errors["impulse"] =
            relative_error(impulse_, contacts * unit_ * force());
        errors["contact_time"] = relative_error(duration_, contacts * unit_);
      }
      errors["energy"] = std::abs(1. - energy_ / initial_energy_);
    }

    void serialize(Archive &archive) override
    {
      archive.numbers("found", time_, momentum_, impulse_, duration_, energy_,
                      initial_energy_);
    }

  private:
    Bar bar_;
    Direction normal_; // of the stop
    double front_ = 0., length_ = 0., unit_ = 0., mass_ = 0., amplitude_ = 0.;
    std::size_t reaction_ = 0;
    double time_ = 0., momentum_ = 0., impulse_ = 0., duration_ = 0.,
           energy_ = 0., initial_energy_ = 0.;

    double share(const Vector &x) const
    {
      return normal_.sign * (x[normal_.axis] - front_) / length_;
    }

    double phase(const double t) const { return std::fmod(t / unit_, 3.); }

    /** Of the stop while in contact: E a / L times the cross-section. */
    double force() const { return mass_ * amplitude_ / (unit_ * unit_); }

    /** A vector away from the stop. */
    Vector along(const double value) const
    {
      Vector result{};
      result[normal_.axis] = normal_.sign * value;
      return result;
    }
  };

  NSFD_REGISTER(VerificationRegistry, StringStop, "string stop",
                "Bar held at one end hits a stop at the other: fields, "
                "impulse, contact time, energy lost");
} // namespace nsfd
