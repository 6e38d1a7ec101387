#include "nsfd/verification/case_input.h"

#include "nsfd/core/archive.h"
#include "nsfd/parameters/section_reader.h"
#include "postprocess/crack_shape.h"

#include <optional>

namespace nsfd
{
  using namespace cases;

  /**
   * Where a crack has gone: the length (in space the area) of what broke during
   * the run, the direction of its principal axis, its extent along it, what it
   * covers of it, how far from straight it is, and when the first point broke.
   * See crack_shape.h. No exact value: the scene may name an angle that is
   * expected of it, and a region outside of which nothing counts.
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
      if (reader.optional("region", "condition on x, y, z: where points count"))
        region_ = reader.expression("region", "", units::none,
                                    "condition on x, y, z: where points count");
    }

    void initialise(const SceneInput &input) override
    {
      dimension_ = input.dimension;
      demand(dimension_ == 2 || !expects_,
             "`expected angle` is for dimension = 2");
    }

    void observe(const StepView &view) override
    {
      if (start_ < 0. && view.row->broken_area > 0.)
        start_ = view.time;
    }

    bool wants_broken_points() const override { return true; }

    void see_broken_points(const std::vector<BrokenPoint> &points) override
    {
      std::vector<BrokenPoint> inside;
      for (const BrokenPoint &point : points) {
        const auto &[x, y, z] = point.position;
        if (!region_ || (*region_)(x, y, z) != 0.)
          inside.push_back(point);
      }
      shape_ = crack_shape(inside, dimension_);
    }

    void finish(std::map<std::string, double> &errors) const override
    {
      errors[dimension_ == 2 ? "crack_length" : "crack_area"] = shape_.area;
      errors["crack_extent"] = shape_.extent;
      errors["crack_projected"] = shape_.projected;
      if (shape_.area == 0.)
        return; // nothing has broken: no direction
      errors["crack_start"] = start_;
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

    void serialize(Archive &archive) override
    {
      archive.numbers("found", start_);
    }

  private:
    unsigned int dimension_ = 2;
    bool expects_ = false;
    double expected_ = 0., start_ = -1.;
    std::optional<Expression> region_; ///< or everywhere
    CrackShape shape_;
  };

  NSFD_REGISTER(VerificationRegistry, CrackPath, "crack path",
                "Where a crack has gone: length, angle, extent, tortuosity");
} // namespace nsfd
