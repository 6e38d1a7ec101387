#pragma once

#include <optional>
#include <string>
#include <vector>

namespace nsfd
{
  /** One setting of a study, as diagrams show it. */
  struct StudyPoint {
    double size = 0.; ///< what the error is a power of; NaN if there is none
    double error = 0.;
    double seconds = 0.; ///< CPU time of the solve
    double unknowns = 0.;
  };

  /** How an error falls with the size, from coarse to fine. */
  struct OrderFit {
    std::vector<double> rates;   ///< between neighbours, one less than points
    std::size_t n_fitted = 0;    ///< points in the least squares fit
    std::optional<double> order; ///< slope of log error over log size
    /// error at which it stops falling; the points from there on are not fitted
    std::optional<double> level;
    bool round_off = false; ///< all errors are: no order
  };

  enum class OrderVerdict { none, too_few, below, reached, above };

  /** "as expected", ... */
  std::string text_of(OrderVerdict verdict);

  /**
   * Rates and order of points sorted by falling size. Points that are not
   * positive and finite are left out. Where all further rates stay below half
   * of the median before, the error levels off; only the points before are
   * fitted that are five times above the level. An order needs three points,
   * and errors above round-off (relative ones, 1000 times that of a double).
   */
  OrderFit fit_order(const std::vector<StudyPoint> &points);

  /**
   * Verdict on an order: within @p tolerance of the expected one, below or
   * above it.
   */
  OrderVerdict judge(const OrderFit &fit, const std::optional<double> &expected,
                     double tolerance);

  /**
   * The lower envelope of error over CPU time: of all points those that no
   * other one beats in both, by rising time.
   */
  std::vector<StudyPoint> lower_envelope(std::vector<StudyPoint> points);

  /** The CPU time that an error costs. */
  struct CostOfError {
    bool reached = false;
    bool at_most = false; ///< the cheapest point is better already
    double seconds = 0.;
  };

  /**
   * Log time over log error, interpolated on the lower envelope of @p points.
   */
  CostOfError cost_of_error(const std::vector<StudyPoint> &points,
                            double error);

  /** Slope and offset of y over x by least squares. */
  struct Line {
    double slope = 0., offset = 0.;
  };
  Line least_squares(const std::vector<double> &x,
                     const std::vector<double> &y);
} // namespace nsfd
