#include "nsfd/verification/case_input.h"

#include "nsfd/core/archive.h"

#include <algorithm>

namespace nsfd
{
  using namespace cases;

  /**
   * Bar of cells of length L_c whose intact faces are compliant in opening and
   * rigid in closing. A pulse of compression from the loaded end runs at
   * c = sqrt(E/rho), its reflection from the free end, now tension, at
   * c / sqrt(1 + E/(C_N L_c)).
   *
   * A pulse passes a cell at the centre of gravity of its velocity over time,
   * taken where it exceeds half of the largest one. The two probes are the
   * cells nearest to 1/4 and 3/4 of the length.
   */
  class Bimodular final : public VerificationCase
  {
  public:
    explicit Bimodular(SectionReader &) {}

    void initialise(const SceneInput &input) override
    {
      const Bar bar = bar_of(input);
      const LoadedSide side = loaded_side(input);
      normal_ = side.normal;
      end_ = side.centre[normal_.axis];
      length_ = extent(input, normal_.axis);
      speed_ = bar.speed;
      const InterfaceInput &faces = cohesive_interface(input);
      demand(!faces.law->extrinsic() && faces.intact == IntactFaces::unilateral,
             "the faces need an intrinsic law and intact faces = unilateral");
      const double L_c = length_ / n_cells(input, normal_.axis);
      slowness_ =
          std::sqrt(1. + bar.young / (faces.law->normal_stiffness() * L_c));
    }

    bool wants_cells() const override { return true; }

    void observe(const StepView &view) override
    {
      if (view.row->step == 0)
        for (unsigned int p = 0; p < probes_.size(); ++p)
          probes_[p] = nearest(*view.cells, places[p] * length_);
      times_.push_back(view.time);
      for (unsigned int p = 0; p < probes_.size(); ++p)
        velocities_[p].push_back(
            -normal_.sign *
            (*view.cells)[probes_[p].cell].velocity[normal_.axis]);
      broken_ = view.row->energy.damage;
    }

    void finish(std::map<std::string, double> &errors) const override
    {
      // the reflection begins when the last cell is fastest
      const std::size_t turn = largest(velocities_[2], 0, times_.size());
      const double from = times_[turn];
      const double until = from + slowness_ * length_ / speed_;
      const std::size_t last =
          std::upper_bound(times_.begin(), times_.end(), until) -
          times_.begin();
      const auto out = [&](const unsigned int p) {
        return passage(velocities_[p], 0, turn);
      };
      const auto back = [&](const unsigned int p) {
        return passage(velocities_[p], turn, last);
      };
      const double way = probes_[1].distance - probes_[0].distance;
      const double compression = out(1) - out(0), tension = back(0) - back(1);
      errors["compression_time"] = relative_error(compression, way / speed_);
      errors["tension_time"] =
          relative_error(tension, slowness_ * way / speed_);
      errors["ratio"] = relative_error(tension / compression, slowness_);
      errors["slowness"] = tension / compression;
      errors["damage"] = broken_;
    }

    void serialize(Archive &archive) override
    {
      archive.numbers("found", broken_);
      archive.common("times", times_);
      for (unsigned int p = 0; p < probes_.size(); ++p) {
        const Archive::Part part(archive, "probe_" + std::to_string(p));
        archive.numbers("place", probes_[p].cell, probes_[p].distance);
        archive.common("velocities", velocities_[p]);
      }
    }

  private:
    static constexpr double places[] = {0.25, 0.75, 1.};
    Direction normal_; // of the loaded end
    double end_ = 0., length_ = 0., speed_ = 0., slowness_ = 1.;
    struct Probe {
      std::size_t cell = 0;
      double distance = 0.; // from the loaded end
    };
    std::array<Probe, 3> probes_;
    std::vector<double> times_;
    std::array<std::vector<double>, 3> velocities_;
    double broken_ = 0.;

    Probe nearest(const std::vector<CellState> &cells,
                  const double distance) const
    {
      Probe best;
      double error = 0.;
      for (std::size_t i = 0; i < cells.size(); ++i) {
        const double x = normal_.sign * (end_ - cells[i].centre[normal_.axis]);
        if (i == 0 || std::abs(x - distance) < error) {
          best = {i, x};
          error = std::abs(x - distance);
        }
      }
      return best;
    }

    static std::size_t largest(const std::vector<double> &v,
                               const std::size_t begin, const std::size_t end)
    {
      return std::max_element(v.begin() + begin, v.begin() + end) - v.begin();
    }

    /** Centre of gravity in time of what exceeds half of the peak. */
    double passage(const std::vector<double> &v, const std::size_t begin,
                   const std::size_t end) const
    {
      const std::size_t peak = largest(v, begin, end);
      const double level = 0.5 * v[peak];
      double sum = 0., moment = 0.;
      const auto add = [&](const std::size_t i) {
        sum += v[i] - level;
        moment += (v[i] - level) * times_[i];
      };
      for (std::size_t i = peak; i < end && v[i] > level; ++i)
        add(i);
      for (std::size_t i = peak; i-- > begin && v[i] > level;)
        add(i);
      return moment / sum;
    }
  };

  NSFD_REGISTER(VerificationRegistry, Bimodular, "bimodular",
                "Pulse in a bar with unilateral faces: arrival in compression "
                "and in tension");
} // namespace nsfd
