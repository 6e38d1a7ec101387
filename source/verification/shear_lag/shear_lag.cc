#include "verification/pulled_fibre.h"

#include "nsfd/core/archive.h"

namespace nsfd
{
  using namespace cases;

  /**
   * A fibre that elastic springs C_T bond to a rigid matrix, pulled at one end
   * by F, the other one free. With k^2 = C_T / (E w),
   *
   *   u(x) = F / (E w k) cosh(k (L - x)) / sinh(k L),
   *
   * and the largest shear of the bond is C_T u(0).
   *
   * The strip is not a line: its shear works like a spring 3 G / w behind the
   * bond, so that C_T w / (6 G) is the relative error of u(0).
   */
  class ShearLag final : public VerificationCase
  {
  public:
    explicit ShearLag(SectionReader &) {}

    void initialise(const SceneInput &input) override
    {
      const PulledFibre fibre(input);
      for (const BoundaryInput &boundary : input.boundaries)
        if (boundary.has_traction)
          force_ = -fibre.half_thickness *
                   boundary.traction[0](0., 0.5 * fibre.half_thickness, 0.,
                                        input.time.end);
      demand(force_ > 0., "a boundary must pull to the left by `traction x`");
      stiffness_ = elastic_interface(input).tangential_stiffness;
      length_ = fibre.length;
      width_ = fibre.half_thickness;
      decay_ = std::sqrt(stiffness_ / (fibre.young * width_));
      end_ = force_ /
             (fibre.young * width_ * decay_ * std::tanh(decay_ * length_));
    }

    bool wants_cells() const override { return true; }

    void observe(const StepView &view) override
    {
      work_ = view.row->energy.work;
      const double scale = end_ / std::cosh(decay_ * length_);
      cells_ = fibre_errors(
          *view.cells,
          [&](const double x) {
            return scale * std::cosh(decay_ * (length_ - x));
          },
          [&](const double x) {
            return scale * stiffness_ / (decay_ * width_) *
                   std::sinh(decay_ * (length_ - x));
          });
      shear_ = shear_error(*view.cells);
    }

    void finish(std::map<std::string, double> &errors) const override
    {
      errors["end_displacement"] = relative_error(2. * work_ / force_, end_);
      errors["displacement"] = cells_.displacement;
      errors["stress"] = cells_.stress;
      errors["shear"] = shear_;
      errors["exact_end_displacement"] = end_;
      errors["exact_peak_shear"] = stiffness_ * end_;
    }

    void serialize(Archive &archive) override
    {
      archive.numbers("found", work_, shear_, cells_.displacement,
                      cells_.stress);
    }

  private:
    double force_ = 0., stiffness_ = 0., length_ = 0., width_ = 0., decay_ = 0.,
           end_ = 0.;
    double work_ = 0., shear_ = 0.;
    FibreErrors cells_;

    /** Of the bond between the two cells at the end: from their balance. */
    double shear_error(const std::vector<CellState> &cells) const
    {
      double x[2] = {length_, length_}, stress[2] = {};
      for (const CellState &cell : cells) {
        if (cell.centre[1] < 0.)
          continue;
        const unsigned int place = cell.centre[0] < x[0] ? 0 : 1;
        if (cell.centre[0] >= x[1])
          continue;
        if (place == 0) {
          x[1] = x[0];
          stress[1] = stress[0];
        }
        x[place] = cell.centre[0];
        stress[place] = cell.stress[0];
      }
      const double middle = 0.5 * (x[0] + x[1]);
      return relative_error(width_ * (stress[0] - stress[1]) / (x[1] - x[0]),
                            stiffness_ * end_ *
                                std::cosh(decay_ * (length_ - middle)) /
                                std::cosh(decay_ * length_));
    }
  };

  NSFD_REGISTER(VerificationRegistry, ShearLag, "shear lag",
                "Fibre bonded by springs, pulled at its end: displacement, "
                "stress, shear of the bond");
} // namespace nsfd
