#include "nsfd/scene/check.h"

#include "nsfd/input/command_line.h"
#include "nsfd/input/scene_input.h"
#include "nsfd/mesh/mesh_builder.h"

#include <cmath>
#include <iostream>

namespace nsfd
{
  namespace
  {
    /** Every expression of the scene at some places and both ends of time. */
    template <int dim>
    std::vector<std::string>
    evaluate_expressions(const SceneInput &input,
                         const Discretization<dim> &discretization)
    {
      std::vector<std::string> problems;
      const auto &points = discretization.points();
      const auto try_at = [&](const Expression &expression,
                              const std::string &name,
                              const dealii::Point<dim> &x) {
        for (const double t : {0., input.time.end}) {
          const double value = expression.at(x, t);
          if (!std::isfinite(value)) {
            problems.push_back(fmt::format(
              "{} = {} is {} at ({:.4g}, {:.4g}{}), t = {:.4g}", name,
              expression.text(), value, x[0], x[1],
              dim == 3 ? fmt::format(", {:.4g}", x[dim - 1]) : "", t));
            return false;
          }
        }
        return true;
      };
      const char *axis[] = {"x", "y", "z"};
      for (unsigned int m = 0; m < input.materials.size(); ++m)
        for (unsigned int c = 0; c < dim; ++c)
          for (const auto &[expression, entry] :
               {std::pair(&input.materials[m].initial_displacement[c],
                          "initial displacement "),
                std::pair(&input.materials[m].initial_velocity[c],
                          "initial velocity "),
                std::pair(&input.materials[m].body_force[c], "body force ")})
            for (std::size_t b = 0; b < discretization.bodies().size(); ++b)
              if (discretization.material_of(unsigned(b)) == m &&
                  !try_at(*expression,
                          "Material: " + input.materials[m].name + "/" +
                            entry + axis[c],
                          discretization.centre(unsigned(b))))
                break;
      std::vector<char> failed(input.boundaries.size(), 0);
      for (std::size_t i = 0; i < points.n_points; ++i) {
        const PointOrigin origin = discretization.origins()[i];
        dealii::Point<dim> x;
        for (unsigned int c = 0; c < dim; ++c)
          x[c] = points.position[i * dim + c];
        if (origin.kind == PointOrigin::Kind::motion && !failed[origin.block]) {
          const auto &boundary = input.boundaries[origin.block];
          for (unsigned int c = 0; c < dim; ++c)
            for (const auto *motion :
                 {&boundary.velocity[c], &boundary.displacement[c]})
              if (*motion && !try_at(**motion,
                                     "Boundary: " + boundary.name +
                                       "/motion " + axis[c],
                                     x))
                failed[origin.block] = 1;
        }
      }
      return problems;
    }
  } // namespace

  template <int dim>
  int print_check(const SceneInput &input,
                  const dealii::Triangulation<dim> &triangulation,
                  const Discretization<dim> &discretization,
                  const double step,
                  const Communicator &communicator)
  {
    const MeshReport mesh = mesh_report<dim>(triangulation);
    const auto problems = evaluate_expressions(input, discretization);
    bool finite = true;
    for (const double t : {0., input.time.end}) {
      std::vector<double> forces(discretization.bodies().n_dofs());
      discretization.add_loads(t, forces);
      for (const double f : forces)
        finite = finite && std::isfinite(f);
    }
    const bool bad = communicator.any(!problems.empty() || !finite);
    for (const auto &problem : problems)
      std::cerr << input.file << ": error: " << problem << "\n";
    if (!finite)
      std::cerr << input.file
                << ": error: a load is not a finite number at the start or the end\n";
    const auto dofs = communicator.sum_integer(discretization.bodies().n_dofs());
    const auto n_points =
      communicator.sum_integer(discretization.points().n_owned);
    const auto classes =
      communicator.max(double(discretization.bodies().classes.size()));
    if (!communicator.is_root())
      return bad ? exit_code::bad_input : exit_code::done;

    auto &out = std::cout;
    out << fmt::format("{}: checked, nothing is run\n", input.file);
    out << fmt::format("  mesh       {} cells, edges {:.4g} to {:.4g}, angles "
                       "{:.3g} to {:.3g} degrees, volume {:.6g}\n",
                       mesh.n_cells, mesh.smallest_edge, mesh.largest_edge,
                       mesh.smallest_angle, mesh.largest_angle, mesh.volume);
    out << fmt::format("  bodies     {} of {} different shapes, {} unknowns, {} "
                       "face points, {}\n",
                       mesh.n_cells, classes, dofs, n_points,
                       discretization.element().get_name());
    const double crossing = discretization.crossing_time();
    for (unsigned int m = 0; m < input.materials.size(); ++m) {
      const auto &material = input.materials[m];
      if (material.rigid)
        out << fmt::format("  material   {}: rigid\n", material.name);
      else
        out << fmt::format("  material   {}: c_p {:.6g}, c_s {:.6g} m/s\n",
                           material.name, discretization.pressure_wave_speed(m),
                           discretization.shear_wave_speed(m));
    }
    if (crossing > 0.)
      out << fmt::format("  step       {:.4g} = {:.3g} crossings of the "
                         "smallest cell (one is {:.4g}), {} steps\n",
                         step, step / crossing, crossing,
                         std::llround(input.time.end / step));
    else
      out << fmt::format("  step       {:.4g}, {} steps\n", step,
                         std::llround(input.time.end / step));

    // the stiffest elastic material around decides for each law
    double stiffest = 0., density = 0., poisson = 0.;
    for (const auto &material : input.materials)
      if (!material.rigid && material.young > stiffest) {
        stiffest = material.young;
        density = material.density;
        poisson = material.poisson;
      }
    const double L = mesh.smallest_height;
    for (const auto &block : input.interfaces) {
      if (!block.law || stiffest == 0.)
        continue;
      const auto &law = *block.law;
      const double zeta = std::isfinite(law.final_opening())
                            ? law.toughness() /
                                (law.strength() * law.final_opening())
                            : 0.5;
      const double mean = zeta * law.strength();
      const double length = M_PI / 8. * stiffest / (1. - poisson * poisson) *
                            law.toughness() / (mean * mean);
      out << fmt::format(
        "  interface  {}: {}, strength {:.4g}, toughness {:.4g}\n", block.name,
        block.law_name, law.strength(), law.toughness());
      const double per_point = input.discretization.interface_points;
      out << fmt::format(
        "             cohesive length {:.3g} = {:.3g} cells = {:.3g} points "
        "({})\n",
        length, length / L, length / L * per_point,
        length / L * per_point >= 2.5
          ? "resolved"
          : "below 2.5: refine, raise the degree or lower the strength");
      // one cell each side, mass only; scalar estimate
      const double chi =
        input.time.cohesion_rule == CohesionRule::exact ? 0.5 : 1.;
      const unsigned int p = input.discretization.degree;
      const double lambda =
        2. * (p + 1.) * (p + 1.) / (density * L); // both sides
      const double unique =
        1. / std::sqrt(input.time.theta * chi * law.steepest_softening() *
                       lambda);
      if (unique > 0.)
        out << fmt::format(
          "             one solution per step is sure below {:.3g} = {:.3g} "
          "crossings while a point softens ({})\n",
          unique, crossing > 0. ? unique / crossing : 0.,
          step <= unique ?
            "this step is below" :
            "this step is above: counted, or write `step = auto`");
      else
        out << "             softens infinitely fast: one solution per step is "
               "sure for no step; steps in which it softens are counted\n";
      if (!law.extrinsic()) {
        const double ratio = law.normal_stiffness() * L / stiffest;
        const double Z = mesh.interface_density;
        const double f =
          dim == 2 ? 3. / 8. + 1. / (8. * law.stiffness_ratio())
                   : 1. / 5. + 2. / (15. * law.stiffness_ratio());
        const double share =
          1. / (1. + stiffest * Z * f / law.normal_stiffness());
        out << fmt::format("             C_N L/E = {:.4g}: about {:.3g} of the "
                           "stiffness is left while intact\n",
                           ratio, share);
      }
    }
    if (bad)
      out << "  not runnable: see the errors above\n";
    return bad ? exit_code::bad_input : exit_code::done;
  }

  template int print_check<2>(const SceneInput &,
                              const dealii::Triangulation<2> &,
                              const Discretization<2> &, double,
                              const Communicator &);
  template int print_check<3>(const SceneInput &,
                              const dealii::Triangulation<3> &,
                              const Discretization<3> &, double,
                              const Communicator &);
} // namespace nsfd
