#include "body_view.h"
#include "chart_axis.h"
#include "colour_map.h"
#include "picture_values.h"
#include "svg_elements.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

namespace nsfd
{
  namespace
  {
    using Colouring = PictureOptions::Colouring;

    const Rgb no_value = {176., 182., 190.};

    /** The largest fragment light grey, others in turn from a palette. */
    std::map<unsigned int, Rgb> fragment_colours(const Snapshot &snapshot)
    {
      static const std::array<unsigned int, 10> palette = {
          0x4f9bd9, 0xf0a33c, 0x3fae8a, 0xd96c75, 0x9a7fd1,
          0x6cc5dd, 0xc9b84a, 0xd98cc0, 0x7fae4f, 0xb98b6a};
      std::map<unsigned int, std::size_t> n_polygons;
      for (const auto &polygon : snapshot.polygons)
        ++n_polygons[polygon.fragment];
      std::vector<std::pair<std::size_t, unsigned int>> by_size;
      for (const auto &[fragment, n] : n_polygons)
        by_size.emplace_back(n, fragment);
      std::sort(
          by_size.begin(), by_size.end(), [](const auto &a, const auto &b) {
            return a.first != b.first ? a.first > b.first : a.second < b.second;
          });
      std::map<unsigned int, Rgb> result;
      for (std::size_t i = 0; i < by_size.size(); ++i)
        result[by_size[i].second] =
            i == 0 ? rgb(0xc3cbd4) : rgb(palette[(i - 1) % palette.size()]);
      return result;
    }

    const Rgb broken_rgb = rgb(0xe3122b);
    const std::string broken_colour = hex(broken_rgb);
    const char *const contact_colour = "#2f9dff";

    std::string damage_colour(const double damage)
    {
      return hex(mix(rgb(0xffc14d), rgb(0xff5a1f), damage));
    }

    std::string stroke(const std::string &colour, const char *stroke_width)
    {
      return fmt::format("class=\"face\" stroke=\"{}\" stroke-width=\"{}\"",
                         colour, stroke_width);
    }

    /** The pieces of one picture, from top to bottom. */
    class BodyPicture
    {
    public:
      BodyPicture(const Snapshot &snapshot, const PictureOptions &options);

      std::string svg(SvgUse use);

    private:
      std::string caption() const;
      std::string flat_cells() const;
      std::string solid_cells() const;
      std::string outline() const;
      std::string faces();
      std::string scale_bar(double y) const;
      std::string colour_bar(double y) const;
      std::string legend(double &y) const;

      Rgb colour_of(const Snapshot::Polygon &polygon) const;
      Vector3 to_pixel(const Vector3 &deformed) const;
      void add_polygon(PathWriter &path,
                       const std::vector<Vector3> &corners) const;

      static constexpr double border = 8.; ///< for strokes

      const Snapshot &snapshot_;
      const PictureOptions &options_;
      const Projection projection_;
      const bool three_dimensional_;
      std::map<unsigned int, Rgb> fragments_; ///< if coloured by them
      std::vector<char> flanks_; ///< of cracks, if they alone are drawn
      std::array<double, 2> extent_;
      double scale_ = 1., left_ = 0.; ///< pixels per metre, of the body
      bool any_damaged_, any_broken_, any_contact_;
    };

    BodyPicture::BodyPicture(const Snapshot &snapshot,
                             const PictureOptions &options)
        : snapshot_(snapshot), options_(options),
          projection_(snapshot, options.magnification),
          three_dimensional_(snapshot.dimension == 3),
          extent_{options.upper[0] - options.lower[0],
                  options.upper[1] - options.lower[1]},
          any_damaged_(options.explain_damaged),
          any_broken_(options.explain_broken ||
                      options.colouring == Colouring::crack),
          any_contact_(options.explain_contact)
    {
      if (options.colouring == Colouring::fragment)
        fragments_ = fragment_colours(snapshot);
      if (options.colouring == Colouring::crack)
        flanks_ = crack_flanks(snapshot);
      const double inner = options.width - 2. * border;
      scale_ = std::min(inner / extent_[0], options.max_height / extent_[1]);
      left_ = (options.width - scale_ * extent_[0]) / 2.;
    }

    std::string BodyPicture::svg(const SvgUse use)
    {
      const std::string title = caption();
      std::string body = text_element(8., 18., "title", title);
      if (snapshot_.polygons.empty() || !(extent_[0] > 0.) ||
          !(extent_[1] > 0.)) {
        body +=
            text_element(options_.width / 2., 70., "mid", "nothing to draw");
        return svg_document(use, options_.width, 120., title, body);
      }
      const double top = 28., height = scale_ * extent_[1] + 2. * border;
      // a nested svg cuts off what leaves the frame
      body += fmt::format("<svg y=\"{}\" width=\"{}\" height=\"{}\">\n",
                          pixel(top), pixel(options_.width), pixel(height));
      if (options_.colouring == Colouring::crack)
        body += outline();
      body += "<g class=\"cells\">\n";
      body += three_dimensional_ ? solid_cells() : flat_cells();
      body += "</g>\n";
      if (!three_dimensional_)
        body += faces();
      body += "</svg>\n";
      double y = top + height + 8.;
      body += scale_bar(y);
      if (options_.colouring == Colouring::stress ||
          options_.colouring == Colouring::speed ||
          options_.colouring == Colouring::warmth)
        body += colour_bar(y);
      y += 48.;
      body += legend(y);
      return svg_document(use, options_.width, y, title, body);
    }

    std::string BodyPicture::caption() const
    {
      std::string text = "t = " + engineering(snapshot_.time, "s");
      if (!fragments_.empty())
        text += fmt::format("  ·  {} fragment{}", fragments_.size(),
                            fragments_.size() == 1 ? "" : "s");
      const double m = options_.magnification;
      if (m == 1.)
        return text + "  ·  true deformation";
      return text + "  ·  deformation × " +
             (m < 1e6 ? fmt::format("{:.0f}", m) : in_scientific(m, 1));
    }

    Vector3 BodyPicture::to_pixel(const Vector3 &deformed) const
    {
      const Vector3 p = projection_.to_plane(deformed);
      return {left_ + scale_ * (p[0] - options_.lower[0]),
              border + scale_ * (options_.upper[1] - p[1]), p[2]};
    }

    void BodyPicture::add_polygon(PathWriter &path,
                                  const std::vector<Vector3> &corners) const
    {
      for (std::size_t i = 0; i < corners.size(); ++i) {
        const Vector3 p = to_pixel(corners[i]);
        i == 0 ? path.move(p[0], p[1]) : path.line(p[0], p[1]);
      }
      path.close();
    }

    /** One of 64 colours. */
    Rgb BodyPicture::colour_of(const Snapshot::Polygon &polygon) const
    {
      if (options_.colouring == Colouring::fragment)
        return fragments_.at(polygon.fragment);
      if (options_.colouring == Colouring::crack)
        return broken_rgb;
      const double value = coloured_value(polygon, options_.colouring);
      if (!std::isfinite(value))
        return no_value;
      const double share =
          options_.colour_max > 0. ? value / options_.colour_max : 0.;
      return colour_map(std::round(63. * std::clamp(share, 0., 1.)) / 63.);
    }

    /** One path for each colour. */
    std::string BodyPicture::flat_cells() const
    {
      std::map<Rgb, PathWriter> paths;
      for (const auto &polygon : snapshot_.polygons) {
        const auto corners = deformed_corners(polygon, projection_);
        if (!corners.empty())
          add_polygon(paths[colour_of(polygon)], corners);
      }
      std::string body;
      for (const auto &[colour, path] : paths)
        body += path_element("color=\"" + hex(colour) + "\"", path);
      return body;
    }

    /** From the back to the front. */
    std::string BodyPicture::solid_cells() const
    {
      struct Facet {
        double depth;
        std::string colour;
        std::vector<Vector3> corners;
      };
      std::vector<Facet> facets;
      const bool glass = options_.colouring == Colouring::crack;
      for (std::size_t p = 0; p < snapshot_.polygons.size(); ++p) {
        if (glass && !flanks_[p])
          continue;
        const auto &polygon = snapshot_.polygons[p];
        auto corners = corners_to_eye(polygon, projection_,
                                      glass ? Seen::both : Seen::front);
        if (corners.empty())
          continue;
        double depth = 0.;
        for (const auto &x : corners)
          depth += projection_.to_plane(x)[2] / corners.size();
        const double light = shade(corners);
        Rgb colour = colour_of(polygon);
        for (auto &component : colour)
          component *= light;
        facets.push_back({depth, hex(colour), std::move(corners)});
      }
      std::stable_sort(
          facets.begin(), facets.end(),
          [](const Facet &a, const Facet &b) { return a.depth < b.depth; });
      std::string body;
      for (std::size_t begin = 0, end = 0; begin < facets.size(); begin = end) {
        PathWriter path;
        for (;
             end < facets.size() && facets[end].colour == facets[begin].colour;
             ++end)
          add_polygon(path, facets[end].corners);
        body += path_element("color=\"" + facets[begin].colour + "\"", path);
      }
      return body;
    }

    /** The edges of the body, as if it were of glass. */
    std::string BodyPicture::outline() const
    {
      PathWriter path;
      for (const auto &edge : sharp_edges(snapshot_, flanks_, projection_)) {
        const Vector3 p = to_pixel(edge[0]), q = to_pixel(edge[1]);
        path.move(p[0], p[1]);
        path.line(q[0], q[1]);
      }
      return path_element("class=\"frame\"", path);
    }

    /** Intact below, broken on the two flanks of the crack. */
    std::string BodyPicture::faces()
    {
      const EdgeFinder edges(snapshot_, std::max(extent_[0], extent_[1]),
                             projection_);
      constexpr unsigned int n_levels = 8;
      // lines closer than a few pixels would only grey the picture
      const bool show_intact =
          scale_ * scale_ * extent_[0] * extent_[1] >
          49. * static_cast<double>(snapshot_.polygons.size());
      PathWriter intact, broken, contact;
      std::array<PathWriter, n_levels> damaged;
      const auto draw = [&](PathWriter &path, const Vector3 &from,
                            const Vector3 &to) {
        const Vector3 p = to_pixel(from), q = to_pixel(to);
        path.move(p[0], p[1]);
        path.line(q[0], q[1]);
      };
      for (const auto &face : snapshot_.faces) {
        const Vector3 a = projection_.deformed(face.a, face.displacement_a);
        const Vector3 b = projection_.deformed(face.b, face.displacement_b);
        if (!is_finite(a) || !is_finite(b))
          continue;
        switch (state_of(face)) {
        case FaceState::contact:
          any_contact_ = true;
          draw(contact, a, b);
          break;
        case FaceState::broken: {
          any_broken_ = true;
          const auto &flanks = edges.find(face);
          for (const auto &edge : flanks)
            draw(broken, edge[0], edge[1]);
          if (flanks.empty())
            draw(broken, a, b);
          break;
        }
        case FaceState::damaged:
          any_damaged_ = true;
          draw(damaged[std::min<std::size_t>(
                   n_levels - 1,
                   static_cast<std::size_t>((1. - face.beta) * n_levels))],
               a, b);
          break;
        case FaceState::intact:
          if (face.can_break && show_intact)
            draw(intact, a, b);
          break;
        }
      }
      std::string body = path_element("class=\"face intact\"", intact);
      for (unsigned int level = 0; level < n_levels; ++level)
        body +=
            path_element(stroke(damage_colour((level + 0.5) / n_levels), "1.3"),
                         damaged[level]);
      return body + path_element(stroke(broken_colour, ".9"), broken) +
             path_element(stroke(contact_colour, "1.6"), contact);
    }

    /** Lengths along an axis are shorter in the isometric view. */
    std::string BodyPicture::scale_bar(const double y) const
    {
      const double axis_scale_3d = three_dimensional_ ? std::sqrt(2. / 3.) : 1.;
      const double length =
          nice_below(0.26 * options_.width / (scale_ * axis_scale_3d));
      const double length_px = length * scale_ * axis_scale_3d;
      std::string body =
          line_path("rule", 10., y + 20., 10. + length_px, y + 20.) +
          text_element(10., y + 36., "name", engineering(length, "m", 1));
      if (!three_dimensional_)
        return body;
      const double x0 = 10. + length_px + 36., y0 = y + 26.;
      const std::array<std::pair<Vector3, const char *>, 3> axes = {
          {{{1., 0., 0.}, "x"}, {{0., 1., 0.}, "y"}, {{0., 0., 1.}, "z"}}};
      for (const auto &[axis, name] : axes) {
        const Vector3 p = projection_.to_plane(axis);
        body += line_path("frame", x0, y0, x0 + 16. * p[0], y0 - 16. * p[1]);
        body +=
            text_element(x0 + 24. * p[0], y0 - 24. * p[1] + 4., "mid", name);
      }
      return body;
    }

    std::string BodyPicture::colour_bar(const double y) const
    {
      const auto [name, base] = options_.colouring == Colouring::stress
                                    ? std::pair("von Mises stress", "Pa")
                                : options_.colouring == Colouring::warmth
                                    ? std::pair("temperature rise", "K")
                                    : std::pair("speed", "m/s");
      const DisplayUnit unit = axis_scale(options_.colour_max, base);
      const double bar = 170., x0 = options_.width - bar - 16.;
      const unsigned int n_parts = 50;
      std::string body =
          text_element(x0, y + 8., "", label_with_unit(name, unit.unit));
      for (unsigned int i = 0; i < n_parts; ++i)
        // each part reaches below the next: no seams
        body += fmt::format(
            "<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"9\" fill=\"{}\"/>\n",
            pixel(x0 + bar * i / n_parts), pixel(y + 14.),
            pixel(bar * (i + 1 < n_parts ? 2. : 1.) / n_parts),
            hex(colour_map((i + 0.5) / n_parts)));
      const double top_value =
          options_.colour_max > 0. ? options_.colour_max / unit.factor : 1.;
      const double step = nice_above(top_value / 4.5);
      const int n_ticks = options_.colour_max > 0.
                              ? static_cast<int>(top_value / step + 1e-9)
                              : 0;
      for (int i = 0; i <= n_ticks; ++i) {
        const double x = x0 + bar * i * step / top_value;
        body += line_path("frame", x, y + 23., x, y + 27.);
        body += text_element(
            x, y + 39., "mid",
            i == 0 ? "0" : fmt::format("{:.{}f}", i * step, decimals_of(step)));
      }
      return body;
    }

    /** What the lines mean; moves @p y if there are any. */
    std::string BodyPicture::legend(double &y) const
    {
      std::string body;
      double x = 10.;
      const auto explain = [&](const bool present, const std::string &colour,
                               const std::string &text) {
        if (!present)
          return;
        body += fmt::format("<path class=\"face\" stroke=\"{}\" "
                            "stroke-width=\"2.5\" d=\"M{} {}h16\"/>\n",
                            colour, pixel(x), pixel(y + 6.));
        body += text_element(x + 22., y + 10., "name", text);
        x += 22. + text_width(text, 12.) + 14.;
      };
      explain(any_damaged_, damage_colour(0.5), "damaged");
      explain(any_broken_, broken_colour, "broken");
      explain(any_contact_, contact_colour, "in contact");
      if (any_damaged_ || any_broken_ || any_contact_)
        y += 18.;
      return body;
    }
  } // namespace

  std::string body_picture(const Snapshot &snapshot,
                           const PictureOptions &options, const SvgUse use)
  {
    return BodyPicture(snapshot, options).svg(use);
  }
} // namespace nsfd
