#include "check.h"

#include "group_report.h"
#include "limiting_cells.h"
#include "motion_report.h"
#include "stress_report.h"

#include "advice.h"
#include "core/exit_code.h"
#include "discretization/cells.h"
#include "materials/anisotropy.h"
#include "mesh/mesh_builder.h"
#include "nsfd/postprocess/observable.h"
#include "nsfd/scene/scene_input.h"
#include "records/certificate.h"
#include "records/engineering.h"
#include "time_integration/moreau_jean.h"

#include <deal.II/fe/fe.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <numeric>

// [AM06]: V. Acary, Y. Monerie, INRIA research report RR-6032, 2006.

namespace nsfd
{
  namespace
  {
    constexpr double points_wanted = points_per_cohesive_length;
    constexpr double share_wanted = 0.9; // of the modulus, while intact
    constexpr unsigned int most_points = 10;

    void line(const char *name, const std::string &text)
    {
      std::cout << fmt::format("    {:<12} {}\n", name, text);
    }
    void change(const std::string &text) { line("", "change: " + text); }

    template <int dim>
    std::vector<MaterialExtremes>
    all_extremes(const SceneInput &input,
                 const Discretization<dim> &discretization)
    {
      std::vector<MaterialExtremes> result;
      for (unsigned int m = 0; m < input.materials.size(); ++m)
        result.push_back(discretization.extremes(m));
      return result;
    }

    /** Waves, and moduli where there is more than one. */
    std::string describe(const MaterialInput &material,
                         const MaterialExtremes &extremes)
    {
      if (!material.graded && material.is_isotropic())
        return fmt::format("c_p {:.6g}, c_s {:.6g} m/s", extremes.fastest,
                           extremes.slowest);
      return fmt::format(
          "{}{}{}, waves {:.6g} to {:.6g} m/s, E {} to {}",
          material.is_isotropic() ? "" : material.model_name,
          material.graded ? material.is_isotropic() ? "graded" : ", graded"
                          : "",
          material.anisotropic
              ? orientation_text(material.anisotropic->orientation)
              : "",
          extremes.slowest, extremes.fastest,
          engineering(extremes.softest.young, "Pa", 4),
          engineering(extremes.stiffest.young, "Pa", 4));
    }

    /** What the advice on all interfaces is computed from. */
    template <int dim>
    struct Advisor {
      const SceneInput &input;
      const MeshReport mesh;
      const std::vector<FaceFamily> families;
      const double step, crossing, diagonal;
      const std::vector<MaterialExtremes> extremes; ///< by material
      /// steps with one solution, per block: 0 if there is none
      std::vector<double> unique_steps = {};
      double contraction = 0., contraction_step = 0.;
      /// of the stiffest elastic material, or the stiffest that an interface
      /// touches while its advice is printed
      double young = 0., poisson = 0., plane_young = 0.;

      void choose_material(const std::vector<unsigned int> &among);
      void print_interface(unsigned int b);
      void print_resolution(const CohesiveLaw &law, double longest,
                            const MaterialExtremes::Moduli &softest) const;
      void print_bounds(const CohesiveLaw &law, const FaceFamily &family) const;
      void print_jumps(const CohesiveLaw &law) const;
      void print_step(const CohesiveLaw &law, double unique) const;
      void print_stiffness() const;
      void print_contraction() const;
      std::string courant_text(double h) const;
    };

    template <int dim>
    void Advisor<dim>::choose_material(const std::vector<unsigned int> &among)
    {
      young = 0.;
      for (const unsigned int m : among)
        if (extremes[m].stiffest.young > young) {
          young = extremes[m].stiffest.young;
          poisson = extremes[m].stiffest.poisson;
        }
      plane_young = dim == 2 && !input.plane_stress
                        ? young / (1. - poisson * poisson)
                        : young;
    }

    template <int dim>
    std::string Advisor<dim>::courant_text(const double h) const
    {
      return crossing > 0. ? fmt::format("{} (Courant number {:.3g})",
                                         engineering(h, "s"), h / crossing)
                           : engineering(h, "s");
    }

    template <int dim>
    void Advisor<dim>::print_interface(const unsigned int b)
    {
      const auto &materials = families[b].materials;
      choose_material(materials);
      const auto &block = input.interfaces[b];
      const auto &law = *block.law;
      std::cout << fmt::format("  interface  {}: {}, strength {}, toughness {}",
                               block.name, block.law_name,
                               engineering(law.strength(), "Pa", 4),
                               engineering(law.toughness(), "J/m²", 4));
      if (!law.extrinsic())
        std::cout << ", C_N " << engineering(law.normal_stiffness(), "Pa/m", 4);
      std::cout << "\n";
      if (young > 0.) {
        // a front runs through the softer side where it is shorter
        print_resolution(
            law, families[b].longest,
            extremes[*std::min_element(
                         materials.begin(), materials.end(),
                         [&](const unsigned int m, const unsigned int n) {
                           return extremes[m].softest.young <
                                  extremes[n].softest.young;
                         })]
                .softest);
        // the compliance of some named faces belongs to the scene
        if (!law.extrinsic() &&
            families[b].density > 0.5 * mesh.interface_density)
          print_bounds(law, families[b]);
        print_jumps(law);
      }
      if (input.may_move())
        print_step(law, unique_steps[b]);
    }

    /** (49)-(52) of [AM06]. */
    template <int dim>
    void Advisor<dim>::print_resolution(
        const CohesiveLaw &law, const double longest,
        const MaterialExtremes::Moduli &softest) const
    {
      const double length =
          cohesive_length(softest.young, softest.poisson, law);
      const double edges = length / longest;
      const unsigned int per_edge = input.discretization.interface_points;
      const double points = edges * per_edge;
      const bool is_resolved = points >= points_wanted;
      line("resolution",
           fmt::format("cohesive length {} = {:.3g} edges = {:.3g} points{}",
                       engineering(length, "m"), edges, points,
                       is_resolved ? ": resolved"
                                   : fmt::format("; it takes {} points",
                                                 points_wanted)));
      if (is_resolved)
        return;
      line("",
           "the fracture energy is right, stresses at a crack front are not");
      const double needed = std::ceil(points_wanted / edges);
      std::string text;
      if (needed <= most_points && !input.time.scheme.at_nodes)
        text = fmt::format("`set interface points = {:g}`, or ", needed);
      change(text +
             fmt::format(
                 "edges of {}, or a strength of {} at this toughness",
                 engineering(length * per_edge / points_wanted, "m"),
                 engineering(law.strength() * std::sqrt(points / points_wanted),
                             "Pa")));
    }

    /** (53) and (80) of [AM06] as an exact rule, (54) for any law. */
    template <int dim>
    void Advisor<dim>::print_bounds(const CohesiveLaw &law,
                                    const FaceFamily &family) const
    {
      const double C_N = law.normal_stiffness();
      const double needed =
          smallest_stiffness(plane_young, family.density, dim,
                             law.stiffness_ratio(), share_wanted);
      const unsigned int points = input.discretization.interface_points;
      const auto bounds = stiffness_bounds(
          needed, young, poisson, law, family.longest, points, points_wanted);
      line("C_N L/E",
           fmt::format("{:.3g} (L = {}, the longest of these faces); both "
                       "at this toughness and shape:",
                       C_N * family.longest / young,
                       engineering(family.longest, "m")));
      line("", fmt::format("at least {:.3g} leaves {} of the modulus, at most "
                           "{:.3g} resolves the cohesive length",
                           bounds.lower, share_wanted, bounds.upper));
      if (C_N < needed && std::isfinite(needed))
        change(fmt::format(
            "a stiffness of {}, so a strength of {}",
            engineering(needed, "Pa/m", 4),
            engineering(law.strength() * std::sqrt(needed / C_N), "Pa", 4)));
      if (!bounds.conflict())
        return;
      line("",
           "conflict on any mesh: faces stiff enough to add no compliance are "
           "too strong to be resolved");
      const double enough = std::ceil(points * bounds.lower / bounds.upper);
      if (input.time.scheme.at_nodes) // points are at the nodes
        change(fmt::format("extrinsic laws, which add no compliance, or "
                           "{:g} points on an edge and another scheme",
                           enough));
      else if (enough <= most_points)
        change(fmt::format("`set interface points = {:g}` ends it", enough));
      else
        line("",
             fmt::format("by {} points on an edge; it takes {:g}. Extrinsic "
                         "laws on named faces add no compliance",
                         points, enough));
    }

    /** (42) of [AM06], with the diagonal of the mesh as the bar. */
    template <int dim>
    void Advisor<dim>::print_jumps(const CohesiveLaw &law) const
    {
      const double slope = law.steepest_softening();
      if (!std::isfinite(slope)) {
        line("jumps", "softens infinitely fast: quasi-static solutions jump "
                      "in a body of any size");
        return;
      }
      const double length = young / slope, ratio = diagonal / length;
      line("jumps",
           fmt::format(
               "max |R'| is {:.3g} E/L (Acary & Monerie 2006, (42)), L = {} "
               "the diagonal: {}",
               ratio, engineering(diagonal, "m"),
               ratio < 1. ? "no quasi-static solution jumps"
                          : "quasi-static solutions jump,"));
      if (ratio >= 1. && input.follows_path())
        line("", "here the loads run backwards instead");
      else if (ratio >= 1.)
        line("", "what they release becomes motion; in bodies below " +
                     engineering(length, "m") + " they do not");
    }

    template <int dim>
    void Advisor<dim>::print_step(const CohesiveLaw &law,
                                  const double unique) const
    {
      if (!std::isfinite(law.steepest_softening())) {
        line("step", "softens infinitely fast: one solution is certain for no "
                     "step; steps in which it softens are counted");
        return;
      }
      if (!(unique > 0.))
        return;
      line("step", fmt::format("one solution is sure below {} while a point "
                               "softens: this step is {}",
                               courant_text(unique),
                               step <= unique ? "below" : "above;"));
      if (step <= unique)
        return;
      const double safe = StepLimits::bound_share * unique;
      if (input.time.step_kind == StepKind::automatic) {
        line("", "`step = auto` shortens it where a point softens");
        const double bisections = std::ceil(std::log2(step / safe));
        if (bisections > input.time.maximum_bisections)
          change(fmt::format("`set maximum bisections = {:g}`, which it takes",
                             bisections));
      } else {
        line("", "such steps are counted (steps_beyond_uniqueness)");
        change(
            fmt::format("`set step = auto`, or `set step = {}`",
                        crossing > 0. && input.time.step_kind != StepKind::time
                            ? fmt::format("{:.2g} courant", safe / crossing)
                            : fmt::format("{:.2g} s", safe)));
      }
    }

    /** By uniform stress along each axis over all blocks. */
    template <int dim>
    void Advisor<dim>::print_stiffness() const
    {
      std::string text;
      bool any = false;
      double density = 0.;
      for (unsigned int b = 0; b < input.interfaces.size(); ++b)
        if (std::isfinite(intact_stiffness(input.interfaces[b])[0]))
          density += families[b].density;
      for (unsigned int a = 0; a < dim; ++a) {
        double compliance = 0.;
        for (unsigned int b = 0; b < input.interfaces.size(); ++b) {
          const auto C = intact_stiffness(input.interfaces[b]);
          compliance += families[b].compliance(a, C[0], C[1]);
        }
        any = any || compliance > 0.;
        text += fmt::format("{}{:.4g} along {}", a ? ", " : "",
                            1. / (1. + plane_young * compliance), "xyz"[a]);
      }
      if (any)
        std::cout << fmt::format(
            "  stiffness  intact faces ({:.4g} 1/m of area per "
            "volume) leave E_eff/E = {}\n",
            density, text);
    }

    /** (38) of [AM06]. */
    template <int dim>
    void Advisor<dim>::print_contraction() const
    {
      if (!(contraction > 0.) || !input.may_move())
        return;
      std::cout << fmt::format(
          "  softening  on all faces at once: flexibility times slope ("
          "Acary & Monerie 2006, (38)) is {:.3g} at this step",
          contraction);
      std::cout << (contraction < 1.
                        ? ", a contraction\n"
                        : fmt::format(",\n             1 at {}\n",
                                      courant_text(contraction_step)));
    }

    /** The step with contraction number 1; W grows where the step shrinks. */
    template <int dim>
    double step_of_contraction(const SceneInput &input,
                               const OneStepProblem<dim> &problem,
                               const State &softening,
                               DelassusOperator<dim> &delassus, double h,
                               double number)
    {
      for (unsigned int k = 0; k < 6 && std::abs(number - 1.) > 0.01; ++k) {
        h /= std::sqrt(number);
        number = contraction_number(input, problem, softening, delassus, h);
      }
      return h;
    }

    template <int dim>
    void print_mesh(const SceneInput &input, const MeshReport &mesh,
                    const Discretization<dim> &discretization,
                    const std::array<double, 3> &counts, const double step)
    {
      auto &out = std::cout;
      out << fmt::format(
          "  mesh       {} cells, edges {} to {}, angles {:.3g} to {:.3g} "
          "degrees, {} {:.6g} {},\n             lowest height {}{}\n",
          mesh.n_cells, engineering(mesh.smallest_edge, "m", 4),
          engineering(mesh.largest_edge, "m", 4), mesh.smallest_angle,
          mesh.largest_angle, dim == 3 ? "volume" : "area", mesh.volume,
          dim == 3 ? "m³" : "m²", engineering(mesh.smallest_height, "m", 4),
          mesh.smallest_radius_ratio > 0.
              ? fmt::format(", inscribed over circumscribed radius at least "
                            "{:.3g} of an equilateral {}",
                            mesh.smallest_radius_ratio,
                            dim == 3 ? "tetrahedron" : "triangle")
              : "");
      for (const auto &[keyword, sentence] : group_report(input))
        out << fmt::format("  {:<10} {}\n", keyword, sentence);
      out << fmt::format("  bodies     {} of {} different shapes, {} unknowns, "
                         "{} face points, {}\n",
                         mesh.n_cells, counts[0], counts[1], counts[2],
                         discretization.cells().element->get_name());
      for (unsigned int m = 0; m < input.materials.size(); ++m) {
        const auto &material = input.materials[m];
        if (material.rigid)
          out << fmt::format("  material   {}: rigid\n", material.name);
        else
          out << fmt::format("  material   {}: {}\n", material.name,
                             describe(material, discretization.extremes(m)));
      }
      for (const auto &[keyword, sentence] : motion_report(input))
        out << fmt::format("  large      {}: {}\n", keyword, sentence);
      for (const ObservableInput &block : input.observables)
        out << fmt::format("  observe    {}: {} {}\n", block.name, block.type,
                           block.observable->text());
      const double crossing = discretization.crossing_time();
      const StaticInput statics = input.statics.value_or(StaticInput());
      if (statics.steps)
        out << fmt::format("  load       {} per step, {} quasi-static "
                           "steps\n",
                           engineering(statics.step, "s", 4),
                           std::llround(statics.until / statics.step));
      if (!input.may_move())
        return;
      const auto n_steps =
          std::llround((input.time.end - statics.until) / step);
      if (crossing > 0.)
        out << fmt::format(
            "  step       {}, Courant number {:.3g} (1 is {}), {} "
            "steps\n",
            engineering(step, "s", 4), step / crossing,
            engineering(crossing, "s", 4), n_steps);
      else
        out << fmt::format("  step       {}, {} steps\n",
                           engineering(step, "s", 4), n_steps);
      if (step > 1.01 * crossing && crossing > 0.)
        out << "             waves cross more than a cell per step: they are "
               "damped or late\n"
               "             change: `set step = 0.5 courant`, unless the "
               "motion is slow\n";
    }

    /** What softening points make of the step. Collective. */
    template <int dim>
    void ask_stepper(const SceneInput &input,
                     const Discretization<dim> &discretization,
                     const MoreauJean<dim> &stepper,
                     DelassusOperator<dim> &delassus, Advisor<dim> &advisor)
    {
      const State state = stepper.initial_state();
      for (int b = 0; b < int(input.interfaces.size()); ++b) {
        const double unique =
            stepper.unique_step(all_softening(state, discretization, input, b));
        advisor.unique_steps.push_back(std::isfinite(unique) ? unique : 0.);
      }
      const State softening = all_softening(state, discretization, input);
      advisor.contraction = contraction_number(
          input, stepper.problem(), softening, delassus, advisor.step);
      if (advisor.contraction >= 1.)
        advisor.contraction_step =
            step_of_contraction(input, stepper.problem(), softening, delassus,
                                advisor.step, advisor.contraction);
    }
  } // namespace

  template <int dim>
  int print_check(const SceneInput &input,
                  const dealii::Triangulation<dim> &triangulation,
                  const Discretization<dim> &discretization,
                  const MoreauJean<dim> *stepper,
                  DelassusOperator<dim> *delassus, const double step,
                  const Communicator &communicator)
  {
    const MeshReport mesh = mesh_report<dim>(triangulation);
    const std::array<double, 3> counts = {
        {communicator.max(double(discretization.bodies().classes.size())),
         double(communicator.sum_integer(discretization.bodies().n_dofs())),
         double(communicator.sum_integer(discretization.points().n_owned))}};

    Advisor<dim> advisor{
        input,
        mesh,
        face_families(input, discretization, mesh.volume, communicator),
        step,
        discretization.crossing_time(),
        discretization.extent(),
        all_extremes(input, discretization)};
    std::vector<unsigned int> all(input.materials.size());
    std::iota(all.begin(), all.end(), 0u);
    advisor.choose_material(all);
    if (stepper)
      ask_stepper(input, discretization, *stepper, *delassus, advisor);
    else
      advisor.unique_steps.assign(input.interfaces.size(), 0.);
    const auto limiting = limiting_cells(input, discretization, communicator);
    const auto stress =
        initial_stress_report(input, discretization, communicator);
    if (!communicator.is_root())
      return exit_code::done;

    std::cout << fmt::format("{}: checked, nothing is run\n", input.file);
    print_mesh(input, mesh, discretization, counts, step);
    std::cout << limiting << stress;
    if (advisor.young > 0.)
      advisor.print_stiffness();
    for (unsigned int b = 0; b < input.interfaces.size(); ++b)
      if (input.interfaces[b].law)
        advisor.print_interface(b);
    advisor.print_contraction();
    return exit_code::done;
  }

  template int print_check<2>(const SceneInput &,
                              const dealii::Triangulation<2> &,
                              const Discretization<2> &, const MoreauJean<2> *,
                              DelassusOperator<2> *, double,
                              const Communicator &);
  template int print_check<3>(const SceneInput &,
                              const dealii::Triangulation<3> &,
                              const Discretization<3> &, const MoreauJean<3> *,
                              DelassusOperator<3> *, double,
                              const Communicator &);
} // namespace nsfd
