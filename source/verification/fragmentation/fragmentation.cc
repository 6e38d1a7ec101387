#include "nsfd/verification/case_input.h"

#include "nsfd/core/archive.h"

namespace nsfd
{
  using namespace cases;

  /**
   * Fragmentation of a ring that expands, cut open: a bar along x that strains
   * everywhere at the same rate, v = rate (x - x_m), its ends held to this
   * motion, so that nothing comes from them. Until the first point reaches its
   * strength the stress is E rate t everywhere: cracks start at R / (E rate),
   * with a scatter of the strength at the weakest point.
   *
   * How many fragments there will be is not known exactly. With the scales of
   * an extrinsic law of strength R and toughness G,
   *
   *   t_0 = E G / (c R^2),   s_0 = c t_0,   rate_0 = R / (E t_0),
   *   x = rate / rate_0,
   *
   * fits of computations give for the mean size s
   *
   *   s / s_0 = 4.5 / (1 + 0.77 x^(1/4) + 5.4 x^(3/4)),  Zhou, Molinari, Ramesh
   *   s / s_0 = 3 / (1 + 4.5 x^(2/3)),                    Levy, Molinari,
   *
   * and the energy balance of Grady (24 / x^2)^(1/3), a bound from above.
   */
  class Fragmentation final : public VerificationCase
  {
  public:
    explicit Fragmentation(SectionReader &) {}

    void initialise(const SceneInput &input) override
    {
      const Bar bar = bar_of(input);
      const InterfaceInput &faces = cohesive_interface(input);
      demand(faces.law->extrinsic(), "the law must be an extrinsic one");
      const Expression &v = input.materials.front().initial_velocity[0];
      const double left = input.mesh.lower[0], right = input.mesh.upper[0];
      length_ = right - left;
      rate_ = (v(right, 0., 0.) - v(left, 0., 0.)) / length_;
      demand(rate_ > 0., "the bar must stretch: `initial velocity x`");
      const double R = faces.law->strength(), G = faces.law->toughness();
      const double t_0 = bar.young * G / (bar.speed * R * R);
      start_ = R / (bar.young * rate_);
      unit_size_ = bar.speed * t_0;
      unit_rate_ = R / (bar.young * t_0);
    }

    void observe(const StepView &view) override
    {
      const HistoryRow &row = *view.row;
      if (measured_start_ == 0. && row.energy.damage > 0.)
        measured_start_ = view.time - 0.5 * view.time_step;
      fragments_ = row.fragments;
    }

    void finish(std::map<std::string, double> &errors) const override
    {
      const double x = rate_ / unit_rate_, size = length_ / fragments_;
      const double zhou =
          4.5 / (1. + 0.77 * std::pow(x, 0.25) + 5.4 * std::pow(x, 0.75));
      const double levy = 3. / (1. + 4.5 * std::pow(x, 2. / 3.));
      errors["start_time"] = relative_error(measured_start_, start_);
      errors["rate_over_rate_0"] = x;
      errors["fragments"] = fragments_;
      errors["size_over_s_0"] = size / unit_size_;
      errors["size_over_zhou"] = size / unit_size_ / zhou;
      errors["size_over_levy"] = size / unit_size_ / levy;
      errors["size_over_grady"] = size / unit_size_ / std::cbrt(24. / (x * x));
    }

    void serialize(Archive &archive) override
    {
      archive.numbers("found", measured_start_, fragments_);
    }

  private:
    double length_ = 0., rate_ = 0., start_ = 0., unit_size_ = 0.,
           unit_rate_ = 0.;
    double measured_start_ = 0., fragments_ = 1.;
  };

  NSFD_REGISTER(VerificationRegistry, Fragmentation, "fragmentation",
                "Stretched bar or cut ring breaks: first crack, mean size of "
                "the fragments against fits");
} // namespace nsfd
