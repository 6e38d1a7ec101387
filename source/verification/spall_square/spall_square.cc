#include "verification/spalling_plane.h"

#include "nsfd/core/archive.h"

namespace nsfd
{
  using namespace cases;

  /**
   * Spall by a square pulse. A pressure sigma_0 on one end of a bar, for the
   * time l/c, sends a pulse of length l to the free end, which returns it as
   * tension. With Z = rho c and s the time since the front has reached the
   * free end, the first tension is sigma_0 at once, at l/2 from that end and
   * s = l/(2c). A plane there opens as SpallingPlane says. The momentum of the
   * pulse stays in the piece, but for the impulse J of the plane:
   *
   *   v = 2 sigma_0/Z - 2 J/(rho l),   and 0 behind the plane for J = 0.
   */
  class SpallSquare final : public VerificationCase
  {
  public:
    explicit SpallSquare(SectionReader &) {}

    void initialise(const SceneInput &input) override
    {
      bar_ = bar_of(input);
      const LoadedSide side = loaded_side(input);
      normal_ = side.normal;
      const unsigned int d = normal_.axis;
      free_end_ = (normal_.sign > 0. ? input.mesh.lower : input.mesh.upper)[d];
      const double length = extent(input, d);
      crossing_ = length / bar_.speed;
      stress_ = -side.tension(0.);
      demand(stress_ > 0., "the pulse must start as a pressure");
      // the end of the pulse, by bisection
      double on = 0., off = input.time.end;
      demand(side.tension(off) == 0., "the pressure must end");
      for (unsigned int i = 0; i < 60; ++i) {
        const double middle = 0.5 * (on + off);
        (side.tension(middle) == 0. ? off : on) = middle;
      }
      pulse_ = off * bar_.speed;
      demand(pulse_ < 2. * length, "the pulse must turn at the free end");
      const CohesiveLaw &law = *cohesive_interface(input).law;
      plane_ = SpallingPlane(law, stress_, bar_.impedance());
      toughness_ = law.toughness() * cross_section(input, d);
    }

    bool wants_cells() const override { return true; }

    void observe(const StepView &view) override
    {
      const double damage = view.row->energy.damage, h = view.time_step;
      // 1e-6 below the end: the round-off of the sum over the points
      const double broken = (1. - 1e-6) * toughness_;
      if (spall_time_ < 0. && damage >= broken)
        spall_time_ = view.time - h * (damage - broken) / (damage - damage_);
      damage_ = damage;
      n_fragments_ = view.row->fragments;

      const unsigned int d = normal_.axis;
      place_ = std::abs(place_of_gap(*view.cells, d) - free_end_);
      double piece = 0., rest = 0., volume = 0.;
      for (const CellState &cell : *view.cells) {
        const double momentum = -normal_.sign * cell.volume * cell.velocity[d];
        const bool is_piece =
            std::abs(cell.centre[d] - free_end_) < 0.5 * pulse_;
        (is_piece ? piece : rest) += momentum;
        volume += is_piece ? cell.volume : 0.;
      }
      piece_velocity_ = piece / volume;
      trapped_ = piece / (piece + rest);
    }

    void finish(std::map<std::string, double> &errors) const override
    {
      const double way = 0.5 * pulse_ / bar_.speed;
      if (spall_time_ >= 0.)
        errors["spall_time"] =
            relative_error(spall_time_, crossing_ + way + plane_.duration());
      errors["spall_place"] = relative_error(place_, 0.5 * pulse_);
      const double lost = 2. * plane_.impulse() / (bar_.density * pulse_);
      errors["piece_velocity"] = relative_error(
          piece_velocity_, 2. * stress_ / bar_.impedance() - lost);
      errors["trapped"] = trapped_;
      errors["damage"] = relative_error(damage_, toughness_);
      errors["fragments"] = n_fragments_;
    }

    void serialize(Archive &archive) override
    {
      archive.numbers("found", damage_, spall_time_, place_, piece_velocity_,
                      trapped_, n_fragments_);
    }

  private:
    Bar bar_;
    Direction normal_; // of the loaded end, outward
    SpallingPlane plane_;
    double free_end_ = 0., crossing_ = 0., stress_ = 0., pulse_ = 0.,
           toughness_ = 0.;
    double damage_ = 0., spall_time_ = -1., place_ = 0., piece_velocity_ = 0.,
           trapped_ = 0.;
    unsigned int n_fragments_ = 0;
  };

  NSFD_REGISTER(VerificationRegistry, SpallSquare, "spall square",
                "Spall of a bar by a square pulse: time, place, momentum of "
                "the piece");
} // namespace nsfd
