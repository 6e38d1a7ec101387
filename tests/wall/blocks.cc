#include "draft.h"

#include <fmt/format.h>

#include <algorithm>

// What bodies are made of, what holds them together and where they touch.

namespace wall
{
  namespace
  {
    using Entries = std::vector<std::string>;

    void append(Entries &a, const Entries &b)
    {
      a.insert(a.end(), b.begin(), b.end());
    }

    Entries model(const Draft &draft, Draw &draw, const Substance &what)
    {
      const bool history = draft.integrator == "moreau-jean";
      std::string name = "linear elastic";
      if (draft.large) {
        name = draw.chance(0.75) ? "neo-hookean" : "saint-venant kirchhoff";
        // what is crushed becomes soft, and turns inside out
        if (draft.speed > 0.1 * draft.slowest.wave_speed())
          name = "neo-hookean";
      }
      if (history && draw.chance(0.1))
        name = draw.chance(0.6) ? "j2 plastic" : "viscoplastic";
      Entries entries = {"model = " + name,
                         "Young modulus = " + pressure(what.young),
                         fmt::format("Poisson ratio = {}", what.poisson)};
      if (name == "j2 plastic" || name == "viscoplastic") {
        entries.push_back("yield stress = " +
                          pressure(what.density * what.wave_speed() *
                                   draft.speed * draw.decades(0.1, 3.)));
        entries.push_back("isotropic hardening modulus = " +
                          pressure(0.01 * what.young));
      }
      if (name == "viscoplastic")
        entries.push_back(
            fmt::format("viscosity = {:.3g} Pa*s",
                        0.01 * what.young * draft.unit / what.wave_speed()));
      if (name == "linear elastic" && !draft.plane_stress &&
          draft.integrator != "arkode" && draw.chance(0.1))
        entries.push_back(fmt::format(
            "shear viscosity = {:.3g} Pa*s",
            what.young * 0.02 * draft.smallest_edge() / what.wave_speed()));
      return entries;
    }

    Entries turned(const Draft &draft, const Body &body)
    {
      // about its centre, in the plane of x and of what is up
      const int u = up(draft);
      const double c = std::cos(body.angle) - 1., s = std::sin(body.angle);
      const Vector m = body.centre();
      return {fmt::format("initial displacement x = {:.12g} * (x - {}) + "
                          "{:.12g} * ({} - {})",
                          c, length(m[0]), -s, axis(u), length(m[u])),
              fmt::format("initial displacement {} = {:.12g} * (x - {}) + "
                          "{:.12g} * ({} - {})",
                          axis(u), s, length(m[0]), c, axis(u), length(m[u]))};
    }

    /** A law, of strength and length as this scene may break. */
    Entries law(const Draft &draft, Draw &draw)
    {
      double young = 1e30, impedance = 0.;
      for (const Body &body : draft.bodies) {
        young = std::min(young, body.substance.young);
        impedance = std::max(impedance, body.substance.density *
                                            body.substance.wave_speed());
      }
      const double strength =
          std::clamp(impedance * draft.speed * draw.decades(0.05, 2.),
                     1e-6 * young, 0.05 * young);
      // the cohesive length in cells, and openings well below a cell
      const double edge = draft.smallest_edge(),
                   toughness = std::min(strength * strength / young * edge *
                                            draw.decades(0.05, 20.),
                                        0.05 * strength * edge);
      static const Entries extrinsic = {"camacho-ortiz", "dugdale",
                                        "ppr-extrinsic"};
      static const Entries intrinsic = {"michel-suquet", "xu-needleman",
                                        "trapezoid", "ppr", "tvergaard"};
      const bool extrinsic_only =
          draft.integrator == "quasi-static" ||
          (draft.large && draft.integrator != "moreau-jean");
      const bool is_extrinsic = draw.chance(0.6) || extrinsic_only;
      const std::string name =
          is_extrinsic ? extrinsic[draw.one_of({3., 1., 1.})]
                       : intrinsic[draw.one_of({3., 1., 1., 1., 1.})];
      Entries entries = {"law = " + name};
      // of strength, stiffness and toughness two are free
      if (name == "michel-suquet")
        entries.push_back(
            fmt::format("stiffness = {:.4g} Pa/m", 21. * young / edge));
      else
        entries.push_back("strength = " + pressure(strength));
      if (name == "tvergaard")
        entries.push_back("critical opening = " +
                          length(2. * toughness / strength));
      else
        entries.push_back(fmt::format("toughness = {:.4g} J/m^2", toughness));
      if (name == "ppr-extrinsic")
        entries.push_back("alpha = 2");
      if (name == "ppr")
        append(entries, {"alpha = 3", "peak ratio = 0.1"});
      if (name == "trapezoid")
        append(entries, {"l1 = 0.15", "l2 = 0.5"});
      if (draw.chance(0.4))
        entries.push_back("strength scatter = 0.1");
      if (draw.chance(0.1))
        entries.push_back("friction exponent = 0");
      if (is_extrinsic && draw.chance(0.1))
        entries.push_back("unloading = plateau");
      return entries;
    }

    /** Where two parts of one mesh meet. */
    Entries seam(const Draft &draft, Draw &draw, const Touch &touch)
    {
      if (draft.jointed && draw.chance(0.6)) {
        if (draw.chance(0.6))
          return {draw.chance(0.6) ? "law = rigid" : "law = joined"};
        if (!draft.large && draft.integrator != "quasi-static")
          return {"law = elastic",
                  fmt::format("normal stiffness = {:.3g} Pa/m",
                              draft.substance.young / draft.unit *
                                  draw.decades(0.1, 100.))};
      }
      Entries entries = {"law = contact"};
      append(entries, touch.entries());
      return entries;
    }
  } // namespace

  std::vector<Block> material_blocks(const Draft &draft, Draw &draw)
  {
    std::vector<Block> blocks;
    Entries deformable;
    std::string substance;
    for (const Body &body : draft.bodies) {
      Entries entries;
      if (draft.bodies.size() > 1)
        entries.push_back("where = " + body.name);
      if (body.rigid) {
        entries.push_back("model = rigid");
        if (draft.large)
          entries.push_back("bodies = connected");
        if (draft.large && body.shape == "ball" &&
            draft.integrator != "explicit")
          entries.push_back("surface = ball");
      } else {
        if (substance != body.substance.name)
          deformable = model(draft, draw, body.substance);
        substance = body.substance.name;
        append(entries, deformable);
      }
      entries.push_back(
          fmt::format("density = {} kg/m^3", body.substance.density));
      for (int d = 0; d < draft.dim; ++d)
        if (body.velocity[d] != 0.)
          entries.push_back(fmt::format("initial velocity {} = {}", axis(d),
                                        speed(body.velocity[d])));
      if (body.angle != 0.)
        append(entries, turned(draft, body));
      blocks.push_back({"Material: " + body.name, entries});
    }
    return blocks;
  }

  std::vector<Block> interface_blocks(const Draft &draft, Draw &draw)
  {
    std::vector<Block> blocks;
    const Touch touch = draw_touch(draw);
    const bool parts = !draft.large || draft.jointed;
    for (std::size_t i = 1; parts && i < draft.bodies.size(); ++i) {
      Entries entries = {fmt::format("where = between materials [{}, {}]",
                                     draft.bodies[i - 1].name,
                                     draft.bodies[i].name)};
      append(entries, seam(draft, draw, touch));
      blocks.push_back({fmt::format("Interface: seam{}", i), entries});
    }
    const auto n = std::count_if(draft.bodies.begin(), draft.bodies.end(),
                                 [](const Body &b) { return b.breakable; });
    const bool all = n == std::ptrdiff_t(draft.bodies.size());
    if (n > 0) {
      Entries entries = law(draft, draw);
      append(entries, touch.entries());
      if (all)
        blocks.push_back({"Interface: cracks", entries});
      else
        for (const Body &body : draft.bodies)
          if (body.breakable) {
            Entries lines = {
                fmt::format("where = between materials [{0}, {0}]", body.name)};
            append(lines, entries);
            blocks.push_back({"Interface: cracks of " + body.name, lines});
          }
    }
    if (!all)
      blocks.push_back(
          {"Interface: inside",
           {"where = all", draw.chance(0.7) || draft.integrator == "arkode"
                               ? "law = joined"
                               : "law = rigid"}});
    if (draft.large && (draft.bodies.size() > 1 || n > 0)) {
      Entries entries = {"between = all"};
      append(entries, touch.entries());
      blocks.push_back({"Contact: any", entries});
    }
    return blocks;
  }
} // namespace wall
