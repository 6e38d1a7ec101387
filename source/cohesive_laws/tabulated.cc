#include "nsfd/cohesive_laws/cohesive_law.h"
#include "nsfd/cohesive_laws/law_input.h"
#include "parameters/input_errors.h"
#include "parameters/parameter_file.h"
#include "parameters/text_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

namespace nsfd
{
  namespace
  {
    /** T / d of points on one line through 0 may differ by this share. */
    constexpr double same_line = 1e-9;

    struct CurvePoint {
      double opening, traction;
      SourceText source; ///< its line
    };

    std::string trimmed(const std::string &text)
    {
      const char *blanks = " \t\r";
      const std::size_t first = text.find_first_not_of(blanks);
      return first == std::string::npos
                 ? ""
                 : text.substr(first,
                               text.find_last_not_of(blanks) - first + 1);
    }

    /** A curve as it was written, and by which entry. */
    struct Curve {
      std::string entry, name; ///< name for messages
      std::vector<CurvePoint> points;
    };

    /** Opening and traction with @p separator in between. */
    void read_point(SectionReader &reader, const SourceText &text,
                    const char separator, const std::string &example,
                    Curve &curve)
    {
      const std::vector<SourceText> parts = text.split(separator);
      if (parts.size() != 2)
        return reader.errors().error(
            text.location(),
            fmt::format("`{}` is not a point of the curve", text.text()),
            "write opening and traction as in: " + example);
      const double opening = reader.number_in(
          parts[0], "opening", "0.2 um", units::length, Range::non_negative());
      const double traction =
          reader.number_in(parts[1], "traction", "3 MPa", units::pressure,
                           Range::non_negative());
      curve.points.push_back({opening, traction, text});
    }

    /** `opening, traction` in every line, a header and comments allowed. */
    void read_lines(SectionReader &reader, std::istream &stream, Curve &curve)
    {
      bool may_be_header = true;
      unsigned int number = 0;
      for (std::string line; std::getline(stream, line);) {
        ++number;
        if (number == 1 && line.compare(0, 3, "\xEF\xBB\xBF") == 0)
          line.erase(0, 3); // the byte order mark of spreadsheets
        line = trimmed(line.substr(0, line.find('#')));
        if (line.empty())
          continue;
        const bool is_header =
            may_be_header &&
            line.find_first_of("0123456789") == std::string::npos;
        may_be_header = false;
        if (!is_header)
          read_point(
              reader,
              SourceText(line, {curve.name, number, 0,
                                static_cast<unsigned int>(line.size()), line}),
              ',', "0.2 um, 3 MPa", curve);
      }
    }

    /** The points of the entry `curve` or `points`; none after an error. */
    std::optional<Curve> read_curve(SectionReader &reader)
    {
      const std::string file_text =
          "CSV file with opening, traction in every line; relative to the "
          "folder of the parameter file";
      const std::string points_text =
          "The curve itself, opening : traction, ... up to traction 0";
      if (reader.has("curve") && reader.has("points"))
        reader.error("points", "`curve` and `points` both give the curve",
                     "remove one of them");
      if (!reader.has("curve") && !reader.has("points"))
        reader.error("curve", "the law tabulated needs `curve` or `points`",
                     "name a CSV file with set curve = curve.csv, or write set "
                     "points = 0 : 0, 0.2 um : 3 MPa, 2 um : 0");

      const unsigned int n_before = reader.errors().n_errors();
      Curve curve;
      if (reader.optional("points", points_text)) {
        curve.entry = curve.name = "points";
        if (const auto value = reader.raw("points", "", points_text))
          for (const SourceText &point : value->split(','))
            read_point(reader, point, ':', "0.2 um : 3 MPa", curve);
      }
      if (reader.optional("curve", file_text)) {
        curve.entry = "curve";
        curve.name = reader.file("curve", file_text, "curve.csv");
        if (curve.name.empty())
          return {};
        const TextFile file =
            read_text_file(curve.name, text_limits::parameter_file);
        std::istringstream stream(file.content);
        if (file.problem.empty())
          read_lines(reader, stream, curve);
        else
          reader.error("curve",
                       fmt::format("`{}` {}", curve.name, file.problem),
                       "name a CSV file; its folder is relative to that of "
                       "the parameter file");
      }
      if (reader.errors().n_errors() > n_before || curve.entry.empty())
        return {};
      return curve;
    }

    struct Complaint {
      std::string message, advice;
    };

    /** Point i of a curve that is @p extrinsic or has begun to fall before. */
    std::optional<Complaint>
    complaint_about(const std::vector<CurvePoint> &points, const std::size_t i,
                    const bool extrinsic, const bool falls)
    {
      const auto &[opening, traction, source] = points[i];
      if (i == 0)
        return {};
      const double last_opening = points[i - 1].opening,
                   last_traction = points[i - 1].traction;
      if (opening <= last_opening)
        return Complaint{
            fmt::format("opening = {:g} is not beyond the opening {:g} of the "
                        "point before",
                        opening, last_opening),
            "sort the points; a traction that jumps needs two openings"};
      if (last_traction == 0. && last_opening > 0.)
        return Complaint{fmt::format("opening = {:g} follows the point where "
                                     "the traction is 0",
                                     opening),
                         "remove this point"};
      if (extrinsic && traction > last_traction)
        return Complaint{
            fmt::format("traction = {:g} grows from {:g} on an extrinsic "
                        "curve, which begins with its strength",
                        traction, last_traction),
            "begin with 0, 0 for a curve that rises"};
      if (falls && traction > last_traction)
        return Complaint{
            fmt::format("traction = {:g} grows from {:g} after it has fallen",
                        traction, last_traction),
            "smooth the curve: it may have one peak"};
      if (last_opening > 0. &&
          traction / opening > (1. + same_line) * last_traction / last_opening)
        return Complaint{
            fmt::format("traction / opening = {:g} grows from {:g}, so beta "
                        "would grow",
                        traction / opening, last_traction / last_opening),
            "stiffness may only be lost along the curve"};
      if (i + 1 == points.size() && traction != 0.)
        return Complaint{
            fmt::format("the curve ends with traction = {:g}", traction),
            "end with the opening at which the traction is 0"};
      return {};
    }

    /** Is this the curve of a law? Reports the first place where not. */
    bool check(SectionReader &reader, const Curve &curve)
    {
      const std::vector<CurvePoint> &points = curve.points;
      if (points.size() < 2) {
        reader.error(curve.entry,
                     fmt::format("`{}` has {} point{}, at least 2 are needed",
                                 curve.name, points.size(),
                                 points.size() == 1 ? "" : "s"),
                     "the curve goes on to the opening where the traction is "
                     "0");
        return false;
      }
      const bool extrinsic = points[0].opening == 0. && points[0].traction > 0.;
      const CurvePoint &first = points[points[0].opening > 0. ? 0 : 1];
      if (first.traction == 0. && !extrinsic) {
        reader.errors().error(
            first.source.location(),
            fmt::format("traction = 0 at opening = {:g}: the curve does not "
                        "rise",
                        first.opening),
            "begin with 0, 0 and the first traction, or with 0 and the "
            "strength of an extrinsic curve");
        return false;
      }
      bool falls = false;
      for (std::size_t i = 0; i < points.size(); ++i) {
        if (const auto complaint =
                complaint_about(points, i, extrinsic, falls)) {
          reader.errors().error(points[i].source.location(), complaint->message,
                                complaint->advice);
          return false;
        }
        falls |= i > 0 && points[i].traction < points[i - 1].traction;
      }
      return true;
    }
  } // namespace

  /**
   * A measured or computed envelope: straight lines between the points
   * (d_i, T_i), against d^2 = <u_N>_+^2 + a^2 |u_T|^2. The last
   * traction is 0.
   *
   * Intrinsic if the curve begins at (0, 0), or beyond (then on a straight
   * line from there): C = T_1 / d_1 and beta = T / (C d), so that T / d may
   * not grow. Extrinsic if it begins at (0, R_max): beta = T / R_max, and T may
   * not grow. Either traction rises, rests at R_max and falls, in this order.
   */
  class Tabulated final : public CohesiveLaw
  {
  public:
    explicit Tabulated(SectionReader &reader)
    {
      set_points(reader);
      set_secants();
      shear_weight_ = laws::read_shear_weight(reader);

      const auto peak = std::max_element(traction_.rbegin(), traction_.rend());
      strength_ = *peak;
      peak_opening_ = opening_[traction_.rend() - peak - 1];
      area_.assign(1, 0.);
      steepest_softening_ = 0.;
      for (std::size_t i = 0; i + 1 < opening_.size(); ++i) {
        const double width = opening_[i + 1] - opening_[i];
        area_.push_back(area_[i] +
                        0.5 * width * (traction_[i] + traction_[i + 1]));
        steepest_softening_ = std::max(
            steepest_softening_, (traction_[i] - traction_[i + 1]) / width);
      }
    }

    bool extrinsic() const override { return traction_[0] > 0.; }
    double normal_stiffness() const override
    {
      return extrinsic() ? std::numeric_limits<double>::infinity() : secant_[1];
    }
    double stiffness_ratio() const override { return shear_weight_; }
    double shear_weight() const override { return shear_weight_; }

    double beta(const double d) const override
    {
      if (extrinsic())
        return traction(d) / strength_;
      return d <= elastic_limit_ ? 1. : line_secant(d) / normal_stiffness();
    }

    double traction(const double d) const override
    {
      if (!extrinsic())
        return beta(d) * normal_stiffness() * d;
      if (d >= final_opening())
        return 0.;
      const std::size_t i = piece(d);
      const double share =
          (opening_[i + 1] - d) / (opening_[i + 1] - opening_[i]);
      return std::min(traction_[i],
                      traction_[i + 1] +
                          (traction_[i] - traction_[i + 1]) * share);
    }

    double energy(const double d) const override
    {
      if (d >= final_opening())
        return toughness();
      const std::size_t i = piece(d);
      return area_[i] + 0.5 * (d - opening_[i]) * (traction_[i] + traction(d));
    }

    /** Trapezoids at both ends, so that close openings lose no digits. */
    double energy_increment(const double d0, const double d1) const override
    {
      if (d1 < d0)
        return -energy_increment(d1, d0);
      const double lower = std::min(d0, final_opening()),
                   upper = std::min(d1, final_opening());
      const std::size_t i = piece(lower), j = piece(upper);
      if (i == j)
        return trapezoid(lower, upper);
      return trapezoid(lower, opening_[i + 1]) + (area_[j] - area_[i + 1]) +
             trapezoid(opening_[j], upper);
    }

    std::vector<double> kinks() const override { return opening_; }
    double elastic_limit() const override { return elastic_limit_; }
    double peak_opening() const override { return peak_opening_; }
    double final_opening() const override { return opening_.back(); }
    double strength() const override { return strength_; }
    double toughness() const override { return area_.back(); }
    double steepest_softening() const override { return steepest_softening_; }

  private:
    std::vector<double> opening_, traction_;
    std::vector<double> secant_; ///< T_i / d_i of intrinsic curves, from 1
    std::vector<double> area_;   ///< I(d_i)
    double strength_, peak_opening_, elastic_limit_;
    double steepest_softening_, shear_weight_;

    /** i with d_i <= d < d_(i+1). */
    std::size_t piece(const double d) const
    {
      return std::upper_bound(opening_.begin() + 1, opening_.end() - 1, d) -
             opening_.begin() - 1;
    }

    double trapezoid(const double lower, const double upper) const
    {
      return 0.5 * (upper - lower) * (traction(lower) + traction(upper));
    }

    /**
     * T / d on the straight line T = a + b d, from its end:
     * T_(i+1) / d_(i+1) + a (1/d - 1/d_(i+1)). With a >= 0 all terms are
     * positive and fall with d, whatever the round-off.
     */
    double line_secant(const double d) const
    {
      if (d >= final_opening())
        return 0.;
      const std::size_t i = piece(d);
      const double width = opening_[i + 1] - opening_[i];
      const double a = traction_[i] * (opening_[i + 1] / width) -
                       traction_[i + 1] * (opening_[i] / width);
      return std::min(secant_[i], secant_[i + 1] + std::max(0., a) *
                                                       (opening_[i + 1] - d) /
                                                       (d * opening_[i + 1]));
    }

    /** C, and secants that do not grow by the last digits of the file. */
    void set_secants()
    {
      elastic_limit_ = 0.;
      secant_.clear();
      if (extrinsic())
        return;
      const double C = traction_[1] / opening_[1];
      secant_.assign(2, C);
      elastic_limit_ = opening_[1];
      for (std::size_t i = 2; i < opening_.size(); ++i) {
        const double last = secant_[i - 1];
        double secant = traction_[i] / opening_[i];
        if (secant >= (1. - same_line) * last) {
          secant = last;
          traction_[i] = secant * opening_[i];
        }
        if (secant == C)
          elastic_limit_ = opening_[i];
        secant_.push_back(secant);
      }
    }

    void set_points(SectionReader &reader)
    {
      // some law, to go on with after an error
      opening_ = {0., 1., 2.};
      traction_ = {0., 1., 0.};
      const std::optional<Curve> curve = read_curve(reader);
      if (!curve || !check(reader, *curve))
        return;

      opening_.clear();
      traction_.clear();
      if (curve->points[0].opening > 0.) {
        opening_.push_back(0.);
        traction_.push_back(0.);
      }
      for (const CurvePoint &point : curve->points) {
        opening_.push_back(point.opening);
        traction_.push_back(point.traction);
      }
    }
  };

  NSFD_REGISTER(CohesiveLawRegistry, Tabulated, "tabulated",
                "Intrinsic or extrinsic, straight lines between points: "
                "opening and traction, in a CSV file or in the scene",
                "points = 0 : 0, 0.3 um : 3 MPa, 1 um : 4 MPa, 2 um : 0; "
                "mode mixity = 1.3",
                "points = 0 : 3 MPa, 2 um : 0");
} // namespace nsfd
