#include "nsfd/verification/case_input.h"

#include "nsfd/core/archive.h"
#include "nsfd/parameters/section_reader.h"

#include <algorithm>

namespace nsfd
{
  using namespace cases;

  namespace
  {
    /**
     * Opening of an interface with traction T(d) that a step of tension
     * sigma_0 meets between bars of impedances Z_1 and Z_2, from d = 0:
     *
     *   d' = 2 sigma_0 / Z_1 - T(d) (1 / Z_1 + 1 / Z_2).
     *
     * The speed depends on d alone, so that the time until an opening is an
     * integral over d, and so is the impulse that the interface transmits.
     */
    struct StepResponse {
      const CohesiveLaw &law;
      double stress, first, second; // sigma_0, Z_1, Z_2

      double speed(const double d) const
      {
        return 2. * stress / first -
               law.traction(d) * (1. / first + 1. / second);
      }

      /** Tension that a closed interface would transmit. */
      double held() const { return 2. * stress * second / (first + second); }

      struct Passage {
        double time = 0., impulse = 0.; ///< s, N s/m^2
      };

      /** From opening @p d0 to @p d1, without kinks between: Gauss, 3 points */
      Passage passage(const double d0, const double d1) const
      {
        constexpr unsigned int n = 4000;
        const double w = (d1 - d0) / n, at = std::sqrt(0.15) * w;
        Passage result;
        for (unsigned int i = 0; i < n; ++i)
          for (const int side : {-1, 0, 1}) {
            const double d = d0 + (i + 0.5) * w + side * at;
            const double dt = w * (side == 0 ? 8. : 5.) / 18. / speed(d);
            result.time += dt;
            result.impulse += law.traction(d) * dt;
          }
        return result;
      }
    };
  } // namespace

  /**
   * A step of tension meets a cohesive interface between two bars. It breaks
   * if and only if a closed interface would transmit more than R_max,
   * 2 sigma_0 Z_2/(Z_1 + Z_2) > R_max; the opening passes the peak and ends at
   * times of a scalar ordinary differential equation, exact until waves come
   * back from the ends of the bars. Otherwise it comes to rest where the law
   * carries that tension.
   *
   * The opening is the one at which the area under the law is what the
   * interface has stored and dissipated; the impulse is the momentum behind
   * the interface.
   */
  class InterfaceLaw final : public VerificationCase
  {
  public:
    explicit InterfaceLaw(SectionReader &) {}

    void initialise(const SceneInput &input) override
    {
      const LoadedSide side = loaded_side(input);
      normal_ = side.normal;
      stress_ = side.tension(0.);
      demand(stress_ > 0. && side.tension(input.time.end) == stress_,
             "the traction must be a step of tension, constant in time");
      area_ = cross_section(input, normal_.axis);
      const InterfaceInput &interface = cohesive_interface(input);
      law_ = interface.law;
      demand(std::isfinite(law_->final_opening()), "the law needs an end");

      const double half = 0.5 * extent(input, normal_.axis);
      middle_ = side.centre[normal_.axis] - normal_.sign * half;
      const Bar first = bar_at(input, side, 0.5 * half),
                second = bar_at(input, side, 1.5 * half);
      arrival_ = half / first.speed;
      demand(input.time.end <=
                 arrival_ + 2. * half / std::max(first.speed, second.speed),
             "the solution is known until waves come back to the middle");
      find_exact({*law_, stress_, first.impedance(), second.impedance()},
                 input.time.end - arrival_);
    }

    bool wants_cells() const override { return true; }

    void observe(const StepView &view) override
    {
      const double h = view.time_step, s = view.time - arrival_;
      const double d = opening(
          (view.row->energy.cohesive + view.row->energy.damage) / area_);
      largest_ = std::max(largest_, d);
      const double peak = law_->peak_opening();
      if (old_ < peak && d >= peak)
        peak_time_ = s - h * (d - peak) / (d - old_);
      // the step in which it breaks ends beyond the law: go on as before
      const bool broken = view.row->broken_area > (1. - 1e-9) * area_;
      if (broken && break_time_ == 0.)
        break_time_ = s - h + (law_->final_opening() - old_) / speed_;
      speed_ = h > 0. ? (d - old_) / h : 0.;
      old_ = d;
      damage_ = view.row->energy.damage / area_;
      impulse_ = 0.;
      for (const CellState &cell : *view.cells)
        if (normal_.sign * (cell.centre[normal_.axis] - middle_) < 0.)
          impulse_ += normal_.sign * cell.velocity[normal_.axis] *
                      density_behind_ * cell.volume / area_;
    }

    /** Times relative to the break time, openings to the final one. */
    void finish(std::map<std::string, double> &errors) const override
    {
      errors["broken"] = (break_time_ > 0.) == breaks_ ? 0. : 1.;
      if (!breaks_) {
        errors["rest"] = std::abs(old_ - rest_) / law_->final_opening();
        errors["overshoot"] = (largest_ - rest_) / law_->final_opening();
        errors["exact_rest"] = rest_ / law_->final_opening();
        return;
      }
      const double unit = impedance_ * law_->final_opening() / law_->strength();
      errors["peak_time"] = std::abs(peak_time_ - to_peak_.time) / to_end_.time;
      errors["break_time"] = relative_error(break_time_, to_end_.time);
      errors["impulse"] = relative_error(impulse_, to_end_.impulse);
      errors["damage"] = relative_error(damage_, law_->toughness());
      errors["exact_peak_time"] = to_peak_.time / unit;
      errors["exact_break_time"] = to_end_.time / unit;
    }

    void serialize(Archive &archive) override
    {
      archive.numbers("found", old_, speed_, largest_, peak_time_, break_time_,
                      damage_, impulse_);
    }

  private:
    std::shared_ptr<const CohesiveLaw> law_;
    Direction normal_;
    double middle_ = 0., stress_ = 0., area_ = 0., arrival_ = 0.;
    double impedance_ = 0., density_behind_ = 0.;
    bool breaks_ = false;
    double rest_ = 0.;
    StepResponse::Passage to_peak_, to_end_;
    double old_ = 0., speed_ = 0., largest_ = 0., peak_time_ = 0.,
           break_time_ = 0., damage_ = 0., impulse_ = 0.;

    /** The bar that is there at a distance from the loaded end. */
    Bar bar_at(const SceneInput &input, const LoadedSide &side,
               const double distance)
    {
      std::array<double, 3> x = side.centre;
      x[normal_.axis] -= normal_.sign * distance;
      const MaterialInput &material = material_at(input, x);
      demand(!material.rigid && material.poisson == 0.,
             "bars are elastic, with `Poisson ratio = 0`");
      density_behind_ = material.density; // of the last one asked for
      return {material.young, material.density,
              std::sqrt(material.young / material.density)};
    }

    void find_exact(const StepResponse &response, const double duration)
    {
      impedance_ = response.first;
      breaks_ = response.held() > law_->strength();
      const double peak = law_->peak_opening(), end = law_->final_opening();
      if (!breaks_) {
        // the traction rises up to the peak
        double low = 0., high = peak;
        for (unsigned int i = 0; i < 200; ++i) {
          const double d = 0.5 * (low + high);
          (law_->traction(d) < response.held() ? low : high) = d;
        }
        rest_ = low;
        return;
      }
      const double limit = std::min(law_->elastic_limit(), peak);
      const auto a = response.passage(0., limit),
                 b = response.passage(limit, peak),
                 c = response.passage(peak, end);
      to_peak_ = {a.time + b.time, a.impulse + b.impulse};
      to_end_ = {to_peak_.time + c.time, to_peak_.impulse + c.impulse};
      demand(to_end_.time < duration, "the run ends before the break");
    }

    /** Where the area under the law is @p energy, in J/m^2. */
    double opening(const double energy) const
    {
      double low = 0., high = law_->final_opening();
      for (unsigned int i = 0; i < 100; ++i) {
        const double d = 0.5 * (low + high);
        (law_->energy(d) < energy ? low : high) = d;
      }
      return 0.5 * (low + high);
    }
  };

  NSFD_REGISTER(VerificationRegistry, InterfaceLaw, "interface law",
                "Step of tension meets a cohesive interface in a bar: times of "
                "peak and break, impulse");
} // namespace nsfd
