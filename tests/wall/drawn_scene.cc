#include "drawn_scene.h"

#include "draft.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace wall
{
  namespace
  {
    std::string with_prefix(const double value, const std::string &unit)
    {
      struct Prefix {
        const char *name;
        double factor;
      };
      static const Prefix prefixes[] = {{"G", 1e9}, {"M", 1e6},  {"k", 1e3},
                                        {"", 1.},   {"m", 1e-3}, {"u", 1e-6}};
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
    void add_block(std::string &text, const Block &block)
    {
      text += "subsection " + block.name + "\n";
      for (const std::string &entry : block.entries)
        text += "  set " + entry + "\n";
      text += "end\n";
    }

    /** Boxes for Gmsh, in mm, each a group of its name. */
    std::string geometry(const Draft &draft)
    {
      const bool plane = draft.dim == 2;
      std::string text = fmt::format(
          "SetFactory(\"OpenCASCADE\");\nMesh.MeshSizeMin = {0:.6g};\n"
          "Mesh.MeshSizeMax = {0:.6g};\n",
          1e3 * draft.mesh_size());
      for (std::size_t i = 0; i < draft.bodies.size(); ++i) {
        const Body &body = draft.bodies[i];
        std::string low, size;
        for (int d = 0; d < draft.dim; ++d) {
          low += fmt::format("{}{:.9g}", d ? ", " : "", 1e3 * body.low[d]);
          size += fmt::format(", {:.9g}", 1e3 * (body.high[d] - body.low[d]));
        }
        text += fmt::format("{0}({1}) = {{{2}{3}{4}}};\n"
                            "Physical {5}(\"{6}\") = {{{1}}};\n",
                            plane ? "Rectangle" : "Box", i + 1, low,
                            plane ? ", 0" : "", size,
                            plane ? "Surface" : "Volume", body.name);
      }
      return text;
    }

    Block mesh_block(const Draft &draft, const Body &body,
                     const std::string &name)
    {
      if (body.shape == "ball") {
        std::string centre;
        for (int d = 0; d < draft.dim; ++d)
          centre += (d ? ", " : "") + fmt::format("{:.9g}", body.centre()[d]);
        return {name,
                {"type = hyper_ball",
                 fmt::format("arguments = {} : {:.9g} : true", centre,
                             0.5 * (body.high[0] - body.low[0]))}};
      }
      std::string cells;
      for (int d = 0; d < draft.dim; ++d)
        cells += (d ? ", " : "") + std::to_string(body.cells[d]);
      const std::string type = body.shape == "notched" ? "notched plate"
                               : body.shape != "box"   ? body.shape
                               : draft.dim == 2        ? "rectangle"
                                                       : "brick";
      Block block{name,
                  {"type = " + type,
                   "lower corner = " + corner(body.low, draft.dim),
                   "upper corner = " + corner(body.high, draft.dim),
                   "cells = " + cells}};
      if (body.shape == "notched") {
        block.entries.push_back("notch length = " +
                                length(std::max(1, body.cells[0] / 3) *
                                       (body.high[0] - body.low[0]) /
                                       body.cells[0]));
        block.entries.push_back("notch height = " + length(body.centre()[1]));
        block.entries.push_back("notch width = " +
                                length(0.5 * body.edge(draft.dim)));
      }
      if (body.distortion > 0.)
        block.entries.push_back(
            fmt::format("distortion = {:.2f}", body.distortion));
      return block;
    }

    /** Of all blocks in @p text. */
    double largest_restitution(const std::string &text)
    {
      const std::string entry = "set restitution = ";
      double largest = 0.;
      for (auto at = text.find(entry); at != std::string::npos;
           at = text.find(entry, at + 1))
        largest = std::max(
            largest, std::strtod(text.c_str() + at + entry.size(), nullptr));
      return largest;
    }

    /**
     * Until bodies have met and waves have crossed them a few times, within
     * what ten seconds allow: cells times steps.
     */
    Block times(const Draft &draft, const double restitution, Draw &draw,
                double &end)
    {
      const bool statics = draft.integrator == "quasi-static",
                 is_explicit = draft.integrator == "explicit" ||
                               draft.integrator == "symplectic" ||
                               draft.integrator == "auto",
                 is_rigid = draft.is_rigid();
      double crossing = draft.smallest_edge() / draft.wave_speed();
      if (is_rigid)
        crossing = draft.smallest_edge() / draft.speed * 0.1;
      const double courant = is_explicit
                                 ? draw.decades(0.1, 0.35)
                                 : draw.decades(0.1, is_rigid ? 5. : 20.);
      const bool is_heavy = draft.iterates_on_cracks();
      const double h = courant * crossing,
                   budget = (draft.dim == 2 ? 1. : 0.25) *
                            (draft.integrator == "explicit" ? 4e5
                             : is_heavy                     ? 2e3
                             : draft.large                  ? 8e3
                                                            : 2e4);
      const double n = std::clamp(budget / draft.n_cells(), 10., 2000.);
      const double wanted =
          2. * draft.gap / draft.speed +
          draft.unit / draft.wave_speed() * draw.decades(2., 50.);
      // what Gmsh makes of a size is known to the program
      const bool in_crossings =
          !is_rigid && (draw.chance(0.5) ||
                        (is_explicit && draft.bodies[0].shape == "gmsh"));
      std::string step =
          !is_rigid && draw.chance(draft.large && is_explicit ? 0.8 : 0.3)
              ? "auto"
          : in_crossings ? fmt::format("{:.3g} courant", courant)
                         : time(h);
      // `auto` is half a crossing
      const double taken =
          is_heavy && step == "auto" ? std::min(h, 0.5 * crossing) : h;
      end = std::min({n * taken, is_rigid ? 1e30 : wanted, draft.longest});
      if (statics) {
        end = 0.01 * draft.unit / draft.speed * draw.decades(0.1, 3.);
        step = time(end / draw.whole(10, 40));
      }
      Block block{"Time", {"end = " + time(end)}};
      // named, so that no default changes what a seed means
      if (draft.integrator != "moreau-jean" || draw.chance(0.2) || draft.large)
        block.entries.push_back("scheme = " + draft.integrator);
      block.entries.push_back("step = " + step);
      if (draft.integrator == "moreau-jean" && draw.chance(0.3))
        // above it the program warns that impacts give energy
        block.entries.push_back(fmt::format(
            "theta = {:.2f}",
            std::max(
                50.,
                std::floor(100. * draw.between(0.5, 1. / (1. + restitution)))) /
                100.));
      if (statics)
        block.entries.push_back(draw.chance(0.5)
                                    ? "at solution jump = relax"
                                    : "at solution jump = dynamic");
      return block;
    }

    /** Kind, motion, integrator, in a way that the program takes. */
    void draw_kind(Draft &draft, Draw &draw)
    {
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
                               (draft.large && !statics && !smooth);
      draft.kind =
          Kind(draw.one_of({takes_rigid ? 1. : 0., 2., smooth ? 0. : 4.,
                            smooth        ? 0.
                            : takes_rigid ? 2.
                                          : 0.5}));
      draft.touches = draft.kind == Kind::rigid ||
                      (!smooth && !statics && draw.chance(0.75));
      if (!draft.touches && draft.kind == Kind::mixed) // there is one body
        draft.kind = Kind::breakable;
      draft.dim = draw.chance(0.25) ? 3 : 2;
      draft.plane_stress = !draft.large && draft.dim == 2 && draw.chance(0.2);
      lay_out(draft, draw);
      for (Body &body : draft.bodies) {
        if (statics)
          body.velocity = {};
        if (!takes_rigid && body.rigid) {
          body.rigid = false;
          body.breakable = !smooth;
        }
      }
      if (draft.large && draw.chance(0.15))
        add_pin(draft, draw);
    }
  } // namespace

  DrawnScene draw_scene(const unsigned int seed)
  {
    Draw draw(seed);
    Draft draft;
    draw_kind(draft, draw);

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
    else if (draft.plane_stress)
      text += "set plane = stress\n";
    if (draft.bodies[0].shape == "gmsh") {
      const std::string file = fmt::format("{}.geo", seed);
      scene.files[file] = geometry(draft);
      add_block(text, {"Mesh",
                       {"type = file", "file = " + file, "length unit = mm"}});
    } else if (draft.bodies.size() == 1)
      add_block(text, mesh_block(draft, draft.bodies[0], "Mesh"));
    else {
      add_block(text, {"Mesh", {"type = bodies"}});
      for (const Body &body : draft.bodies)
        add_block(text, mesh_block(draft, body, "Body: " + body.name));
    }
    for (const Block &block : material_blocks(draft, draw))
      add_block(text, block);
    for (const Block &block : interface_blocks(draft, draw))
      add_block(text, block);
    for (const Block &block : draft.blocks)
      add_block(text, block);
    if (draft.gravity > 0.) {
      add_block(text, {"Loads",
                       {draft.dim == 2 ? "gravity = 0, -9.81 m/s^2"
                                       : "gravity = 0, 0, -9.81 m/s^2"}});
      draft.keeps_momentum = false;
    }
    if (!draft.large && draft.integrator == "moreau-jean" && draw.chance(0.15))
      add_block(text, {"Discretization", {"degree = 2"}});
    add_block(text, times(draft, largest_restitution(text), draw, scene.end));
    add_block(text, {"Output", {"fields = false", "report = false"}});
    scene.keeps_momentum = draft.keeps_momentum;
    return scene;
  }
} // namespace wall
