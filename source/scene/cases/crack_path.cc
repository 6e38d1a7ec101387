#include "case_input.h"

#include "nsfd/input/section_reader.h"
#include "nsfd/scene/crack_shape.h"

namespace nsfd
{
  using namespace cases;

  /**
   * Where a crack has gone: the length (in space the area) of what broke during
   * the run, the direction of its principal axis, its extent along it, what it
   * covers of it, and how far from straight it is. See crack_shape.h. No exact value: the scene may
   * name an angle that is expected of it.
   *
   * In space `normal_x`, `_y`, `_z` are those of the mean plane, z >= 0.
   */
  class CrackPath final : public VerificationCase
  {
  public:
    explicit CrackPath(SectionReader &reader)
    {
      expects_ = reader.optional("expected angle",
                                 "of the crack to the x axis, in degrees: its "
                                 "deviation is reported (2D)");
      if (expects_)
        expected_ = reader.number("expected angle", "", units::none,
                                  Range::closed(-180., 180.),
                                  "of the crack to the x axis, in degrees");
    }

    void initialise(const SceneInput &input) override
    {
      dimension_ = input.dimension;
      demand(dimension_ == 2 || !expects_,
             "`expected angle` is for dimension = 2");
    }

    bool wants_broken_points() const override { return true; }

    void see_broken_points(const std::vector<BrokenPoint> &points) override
    {
      shape_ = crack_shape(points, dimension_);
    }

    void finish(std::map<std::string, double> &errors) const override
    {
      errors[dimension_ == 2 ? "crack_length" : "crack_area"] = shape_.area;
      errors["crack_extent"] = shape_.extent;
      errors["crack_projected"] = shape_.projected;
      if (shape_.area == 0.)
        return; // nothing has broken: no direction
      errors["crack_tortuosity"] = shape_.tortuosity;
      if (dimension_ == 2) {
        errors["crack_angle"] = crack_angle(shape_);
        if (expects_)
          errors["crack_deviation"] =
              angle_between(crack_angle(shape_), expected_);
        return;
      }
      const auto &normal = shape_.axes[2];
      const double sign = normal[2] < 0. ? -1. : 1.;
      errors["crack_normal_x"] = sign * normal[0];
      errors["crack_normal_y"] = sign * normal[1];
      errors["crack_normal_z"] = sign * normal[2];
    }

  private:
    unsigned int dimension_ = 2;
    bool expects_ = false;
    double expected_ = 0.;
    CrackShape shape_;
  };

  NSFD_REGISTER(VerificationRegistry, CrackPath, "crack path",
                "Where a crack has gone: length, angle, extent, tortuosity");
} // namespace nsfd
