#pragma once

#include "markup.h"
#include "nsfd/records/run_record.h"
#include "records/engineering.h"

#include <array>
#include <string>
#include <vector>

namespace nsfd
{
  class AxisMap;

  /** Whether a picture is a file of its own or part of a page. */
  enum class SvgUse { file, page };

  /**
   * CSS rules of the classes that the pictures use. Files carry their own; a
   * page includes them once. The colours are variables, so that a page may
   * redefine them in svg_dark_colours().
   */
  std::string svg_style();
  std::string svg_dark_colours();

  /**
   * Curves over one axis: linear or logarithmic, with ticks at 1-2-5 steps,
   * engineering prefixes, and the legend above the data. Non-finite values
   * leave a gap, as do values that are not positive on a logarithmic axis.
   * Long series are reduced to their smallest and largest value per pixel.
   */
  class LineChart
  {
  public:
    struct Axis {
      std::string label, unit;
      bool logarithmic = false;
    };

    enum class Colour {
      blue,
      orange,
      green,
      red,
      pink,
      sky,
      olive,
      violet,
      grey,
      ink
    };

    /** Colours in the order in which they are told apart best. */
    static Colour palette(unsigned int index);

    LineChart(const std::string &title, const Axis &x, const Axis &y);

    void add_line(const std::string &name, const std::vector<double> &x,
                  const std::vector<double> &y, Colour colour,
                  bool dashed = false);

    /** A filled area between two curves. */
    void add_band(const std::string &name, const std::vector<double> &x,
                  const std::vector<double> &lower,
                  const std::vector<double> &upper, Colour colour);

    std::string svg(SvgUse use) const;

  private:
    struct Series {
      std::string name;
      std::vector<double> x, y, lower; ///< `lower` for bands only
      Colour colour;
      bool dashed;
    };

    bool set_axes(AxisMap &x_axis, AxisMap &y_axis) const;
    std::string legend(double &y) const;

    std::string title_;
    Axis x_, y_;
    std::vector<Series> series_;
  };

  /** How body_picture() draws; the same for all pictures of a series. */
  struct PictureOptions {
    /// crack: in space, the flanks of cracks inside the outline of the body
    enum class Colouring { stress, speed, warmth, fragment, crack };

    Colouring colouring = Colouring::stress;
    /// the displacement is drawn this many times larger; its mean is not
    double magnification = 1.;
    double colour_max = 0.; ///< Pa, m/s or K at the upper end of the colour map
    /// frame in the drawing plane (m); all of it must be set
    std::array<double, 2> lower{}, upper{};
    double width = 400., max_height = 340.; ///< of the body, in pixels
    /// states of faces that the legend names also where there are none
    bool explain_damaged = false, explain_broken = false,
         explain_contact = false;
  };

  /**
   * Options that suit all of the snapshots: a displacement too small to be
   * seen is magnified to 5 % of the size, rounded to 1, 2 or 5; the colour map
   * ends at the largest value (a few singular cells left out).
   */
  PictureOptions picture_options(
      const std::vector<Snapshot> &snapshots,
      PictureOptions::Colouring colouring = PictureOptions::Colouring::stress);

  /**
   * The body at one time: cells in the colours of the map, gaps where faces
   * have opened, the state of the faces. 3D: isometric view.
   */
  std::string body_picture(const Snapshot &snapshot,
                           const PictureOptions &options, SvgUse use);
} // namespace nsfd
