#include "drawn_scene.h"

#include "draft.h"

#include <fmt/format.h>

#include <algorithm>

namespace wall
{
  namespace
  {
    std::string with_prefix(const double value, const std::string &unit)
    {
      if (value == 0.)
        return "0";
      struct Prefix {
        const char *name;
        double factor;
      };
      static const Prefix prefixes[] = {{"G", 1e9}, {"M", 1e6},  {"k", 1e3},
                                        {"", 1.},   {"m", 1e-3}, {"u", 1e-6},
                                        {"n", 1e-9}};
      for (const Prefix &prefix : prefixes)
        if (std::abs(value) >= 0.9999999 * prefix.factor)
          return fmt::format("{:.6g} {}{}", value / prefix.factor, prefix.name,
                             unit);
      return fmt::format("{:.6g} n{}", value * 1e9, unit);
    }
  } // namespace

  std::string length(const double metres)
  {
    return metres == 0. ? "0" : fmt::format("{:.9g} mm", metres * 1e3);
  }
  std::string speed(const double value)
  {
    return fmt::format("{:.4g} m/s", value);
  }
  std::string pressure(const double value) { return with_prefix(value, "Pa"); }
  std::string time(const double value) { return with_prefix(value, "s"); }

  namespace
  {
    using Lines = std::string;

    /** Indented and aligned by nobody: a block of a parameter file. */
    void add_block(std::string &text, const std::string &name,
                   const std::vector<std::string> &entries)
    {
      text += "subsection " + name + "\n";
      for (const std::string &entry : entries)
        text += "  set " + entry + "\n";
      text += "end\n";
    }

    std::string corner(const Vector &point, const int dim)
    {
      std::string text;
      for (int d = 0; d < dim; ++d)
        text += (d ? ", " : "") + length(point[d]);
      return text;
    }

    void write_body(std::string &text, const Draft &draft, const Body &body,
                    const std::string &name)
    {
      std::vector<std::string> entries;
      if (body.shape == "ball") {
        std::string centre;
        for (int d = 0; d < draft.dim; ++d)
          centre += (d ? ", " : "") + fmt::format("{:.9g}", body.centre()[d]);
        entries = {"type = hyper_ball",
                   fmt::format("arguments = {} : {:.9g} : true", centre,
                               0.5 * (body.high[0] - body.low[0]))};
      } else {
        const std::string type =
            body.shape == "box" ? (draft.dim == 2 ? "rectangle" : "brick")
            : body.shape == "triangles" ? "crossed triangles"
                                        : "tetrahedra";
        std::string cells;
        for (int d = 0; d < draft.dim; ++d)
          cells += (d ? ", " : "") + std::to_string(body.cells[d]);
        entries = {"type = " + type,
                   "lower corner = " + corner(body.low, draft.dim),
                   "upper corner = " + corner(body.high, draft.dim),
                   "cells = " + cells};
      }
      add_block(text, name, entries);
    }

    void write_material(std::string &text, const Draft &draft, const Body &body,
                        const std::string &model)
    {
      const Substance &what = body.substance;
      std::vector<std::string> entries;
      if (draft.bodies.size() > 1)
        entries.push_back("where = " + body.name);
      if (body.rigid) {
        entries.push_back("model = rigid");
        if (draft.large)
          entries.push_back("bodies = connected");
        if (draft.large && body.shape == "ball")
          entries.push_back("surface = ball");
      } else {
        entries.push_back("model = " + model);
        entries.push_back("Young modulus = " + pressure(what.young));
        entries.push_back(fmt::format("Poisson ratio = {}", what.poisson));
      }
      entries.push_back(fmt::format("density = {} kg/m^3", what.density));
      for (int d = 0; d < draft.dim; ++d)
        if (body.velocity[d] != 0.)
          entries.push_back(fmt::format("initial velocity {} = {}", "xyz"[d],
                                        speed(body.velocity[d])));
      if (body.angle != 0.) {
        // about its centre, in the plane of x and of what is up
        const int u = draft.dim - 1;
        const double c = std::cos(body.angle) - 1., s = std::sin(body.angle);
        const Vector m = body.centre();
        entries.push_back(fmt::format(
            "initial displacement x = {:.12g} * (x - {}) - {:.12g} * ({} - {})",
            c, length(m[0]), s, "xyz"[u], length(m[u])));
        entries.push_back(fmt::format("initial displacement {} = {:.12g} * (x "
                                      "- {}) + {:.12g} * ({} - {})",
                                      "xyz"[u], s, length(m[0]), c, "xyz"[u],
                                      length(m[u])));
      }
      add_block(text, "Material: " + body.name, entries);
    }

    /** A law, of strength and length as this scene may break. */
    std::vector<std::string> law(const Draft &draft, Draw &draw,
                                 const bool extrinsic_only)
    {
      double young = 1e30, impedance = 0.;
      for (const Body &body : draft.bodies)
        if (body.breakable) {
          young = std::min(young, body.substance.young);
          impedance = std::max(impedance, body.substance.density *
                                              body.substance.wave_speed());
        }
      const double strength =
          std::clamp(impedance * draft.speed * draw.decades(0.05, 2.),
                     1e-6 * young, 0.05 * young);
      const double edge = draft.smallest_edge(),
                   toughness = strength * strength / young * edge *
                               draw.decades(0.05, 20.);
      static const std::vector<std::string> extrinsic = {
          "camacho-ortiz", "dugdale", "ppr-extrinsic"};
      static const std::vector<std::string> intrinsic = {
          "michel-suquet", "xu-needleman", "trapezoid", "ppr"};
      std::vector<std::string> entries;
      if (extrinsic_only || draw.chance(0.6))
        entries.push_back("law = " + extrinsic[draw.one_of({3., 1., 1.})]);
      else
        entries.push_back("law = " + intrinsic[draw.one_of({3., 1., 1., 1.})]);
      entries.push_back("strength = " + pressure(strength));
      entries.push_back(fmt::format("toughness = {:.4g} J/m^2", toughness));
      if (entries[0] == "law = michel-suquet") {
        // of strength, stiffness and toughness two are free
        entries.erase(entries.begin() + 1);
        entries.push_back(
            fmt::format("stiffness = {:.4g} Pa/m", 21. * young / edge));
      } else if (entries[0] == "law = ppr-extrinsic")
        entries.push_back("alpha = 2");
      if (draw.chance(0.4))
        entries.push_back("strength scatter = 0.1");
      return entries;
    }

    struct Touch {
      double friction = 0., restitution = 0.;
      std::vector<std::string> entries() const
      {
        std::vector<std::string> lines;
        if (friction > 0.)
          lines.push_back(fmt::format("friction = {:.2f}", friction));
        if (restitution > 0.)
          lines.push_back(fmt::format("restitution = {:.2f}", restitution));
        return lines;
      }
    };

    void append(std::vector<std::string> &a, const std::vector<std::string> &b)
    {
      a.insert(a.end(), b.begin(), b.end());
    }

    void write_interfaces(std::string &text, const Draft &draft, Draw &draw,
                          const bool extrinsic_only)
    {
      const Touch touch{draw.chance(0.25)
                            ? 0.
                            : draw.between(0., draw.chance(0.7) ? 0.8 : 2.),
                        draw.chance(0.6)   ? 0.
                        : draw.chance(0.1) ? 1.
                                           : draw.between(0., 1.)};
      // parts of one mesh
      if (!draft.large && draft.bodies.size() > 1)
        for (std::size_t i = 1; i < draft.bodies.size(); ++i) {
          std::vector<std::string> entries = {
              fmt::format("where = between materials [{}, {}]",
                          draft.bodies[i - 1].name, draft.bodies[i].name),
              "law = contact"};
          append(entries, touch.entries());
          add_block(text, fmt::format("Interface: seam{}", i), entries);
        }
      const auto n = std::count_if(draft.bodies.begin(), draft.bodies.end(),
                                   [](const Body &b) { return b.breakable; });
      const bool all = n == std::ptrdiff_t(draft.bodies.size());
      if (n > 0) {
        const std::vector<std::string> entries =
            law(draft, draw, extrinsic_only);
        for (const Body &body : draft.bodies)
          if (body.breakable) {
            std::vector<std::string> lines;
            if (!all)
              lines.push_back(fmt::format(
                  "where = between materials [{0}, {0}]", body.name));
            append(lines, entries);
            append(lines, touch.entries());
            add_block(text,
                      all ? "Interface: cracks"
                          : "Interface: cracks of " + body.name,
                      lines);
            if (all)
              break;
          }
      }
      if (!all)
        add_block(
            text, "Interface: inside",
            {"where = all", draw.chance(0.7) || draft.integrator == "arkode"
                                ? "law = joined"
                                : "law = rigid"});
      if (draft.large && (draft.bodies.size() > 1 || n > 0)) {
        std::vector<std::string> entries = {"between = all"};
        append(entries, touch.entries());
        add_block(text, "Contact: any", entries);
      }
    }

    struct Times {
      double end = 0.;
      std::string step;
    };

    /**
     * Until bodies have met and waves have crossed them a few times, within
     * what ten seconds allow: `budget` counts cells times steps.
     */
    Times times(const Draft &draft, Draw &draw)
    {
      const bool is_explicit =
          draft.integrator == "explicit" || draft.integrator == "symplectic";
      double crossing = draft.smallest_edge() / draft.wave_speed();
      if (draft.kind == Kind::rigid)
        crossing = draft.smallest_edge() / draft.speed * 0.1;
      const double courant =
          is_explicit ? 0.3
                      : draw.decades(0.1, draft.kind == Kind::rigid ? 5. : 20.);
      const double h = courant * crossing,
                   budget =
                       (draft.dim == 2 ? 1. : 0.25) * (is_explicit   ? 4e5
                                                       : draft.large ? 8e3
                                                                     : 2e4);
      const double n = std::clamp(budget / draft.n_cells(), 10., 2000.);
      Times result;
      const double wanted =
          2. * draft.gap / draft.speed +
          draft.unit / draft.wave_speed() * draw.decades(2., 50.);
      result.end = std::min(n * h, draft.kind == Kind::rigid ? 1e30 : wanted);
      const bool automatic = draft.kind != Kind::rigid &&
                             ((draft.large && is_explicit) ||
                              draw.chance(0.3) || draft.integrator == "auto");
      result.step = automatic ? "auto"
                    : draw.chance(0.5) && draft.kind != Kind::rigid
                        ? fmt::format("{:.3g} courant", courant)
                        : time(h);
      return result;
    }
  } // namespace

  DrawnScene draw_scene(const unsigned int seed)
  {
    Draw draw(seed);
    Draft draft;
    draft.large = draw.chance(0.65);
    static const std::vector<std::string> integrators = {
        "explicit",   "moreau-jean", "auto",
        "symplectic", "arkode",      "quasi-static"};
    draft.integrator = integrators[draw.one_of(
        draft.large ? std::vector<double>{9, 7, 4}
                    : std::vector<double>{5, 7, 3, 2, 1, 2})];
    const bool smooth = draft.integrator == "arkode",
               statics = draft.integrator == "quasi-static",
               takes_rigid = draft.integrator == "moreau-jean" ||
                             (draft.integrator == "auto" && draft.large);
    draft.kind = Kind(draw.one_of({takes_rigid ? 1. : 0., 2., smooth ? 0. : 4.,
                                   smooth        ? 0.
                                   : takes_rigid ? 2.
                                                 : 0.5}));
    draft.touches =
        draft.kind == Kind::rigid || (!smooth && !statics && draw.chance(0.75));
    draft.dim = draw.chance(0.25) ? 3 : 2;
    lay_out(draft, draw);
    if (statics)
      for (Body &body : draft.bodies)
        body.velocity = {};
    if (!takes_rigid)
      for (Body &body : draft.bodies)
        if (body.rigid) {
          body.rigid = false;
          body.breakable = !smooth;
        }

    DrawnScene scene;
    static const char *const kinds[] = {"rigid", "elastic", "breakable",
                                        "mixed"};
    scene.kind = fmt::format("{} {} {} {}", draft.large ? "large" : "small",
                             draft.integrator, kinds[int(draft.kind)],
                             draft.touches ? "contact" : "alone");
    std::string &text = scene.text;
    text = fmt::format("# wall of scenes, seed {}: {}\nset dimension = {}\n",
                       seed, scene.kind, draft.dim);
    if (draft.large)
      text += "set motion = large\n";
    if (draft.bodies.size() == 1)
      write_body(text, draft, draft.bodies[0], "Mesh");
    else {
      add_block(text, "Mesh", {"type = bodies"});
      for (const Body &body : draft.bodies)
        write_body(text, draft, body, "Body: " + body.name);
    }
    const std::string model = !draft.large        ? "linear elastic"
                              : draw.chance(0.75) ? "neo-hookean"
                                                  : "saint-venant kirchhoff";
    for (const Body &body : draft.bodies)
      write_material(text, draft, body, model);
    write_interfaces(text, draft, draw,
                     statics ||
                         (draft.large && draft.integrator != "moreau-jean"));
    for (const Block &block : draft.blocks)
      add_block(text, block.name, block.entries);
    if (draft.gravity > 0.) {
      add_block(text, "Loads",
                {draft.dim == 2 ? "gravity = 0, -9.81 m/s^2"
                                : "gravity = 0, 0, -9.81 m/s^2"});
      draft.keeps_momentum = false;
    }
    Times time = times(draft, draw);
    std::vector<std::string> entries;
    if (statics) {
      time.end = 0.01 * draft.unit / draft.speed * draw.decades(0.1, 3.);
      time.step = wall::time(time.end / draw.whole(10, 40));
    }
    entries.push_back("end = " + wall::time(time.end));
    if (draft.integrator != "moreau-jean")
      entries.push_back("scheme = " + draft.integrator);
    entries.push_back("step = " + time.step);
    if (draft.integrator == "moreau-jean" && draw.chance(0.3))
      entries.push_back(fmt::format("theta = {:.2g}", draw.between(0.5, 1.)));
    if (statics)
      entries.push_back("at solution jump = relax");
    add_block(text, "Time", entries);
    add_block(text, "Output", {"fields = false", "report = false"});
    scene.end = time.end;
    scene.keeps_momentum = draft.keeps_momentum;
    return scene;
  }
} // namespace wall
