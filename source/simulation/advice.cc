#include "advice.h"

#include "discretization/cells.h"
#include "nsfd/scene/scene_input.h"
#include "state/state.h"

#include <cmath>
#include <limits>

namespace nsfd
{
  double mean_traction_ratio(const CohesiveLaw &law)
  {
    return std::isfinite(law.final_opening())
               ? law.toughness() / (law.strength() * law.final_opening())
               : 0.;
  }

  double cohesive_length(const double young, const double poisson,
                         const CohesiveLaw &law)
  {
    const double zeta = mean_traction_ratio(law);
    const double mean = (zeta > 0. ? zeta : 0.5) * law.strength();
    return M_PI / 8. * young / (1. - poisson * poisson) *
           (law.toughness() / mean / mean);
  }

  NormalAverage isotropic_average(const unsigned int dimension)
  {
    if (dimension == 2)
      return {3. / 8., 1. / 8.};
    return {1. / 5., 2. / 15.};
  }

  double smallest_stiffness(const double young, const double Z,
                            const unsigned int dimension,
                            const double stiffness_ratio, const double eta)
  {
    const NormalAverage n = isotropic_average(dimension);
    return young * Z * (n.normal + n.shear / stiffness_ratio) * eta /
           (1. - eta);
  }

  StiffnessBounds stiffness_bounds(const double smallest_stiffness,
                                   const double young, const double poisson,
                                   const CohesiveLaw &law, const double L,
                                   const unsigned int points,
                                   const double resolved)
  {
    // L_czm is inversely proportional to C_N at this shape and toughness
    const double length = cohesive_length(young, poisson, law);
    return {smallest_stiffness * L / young,
            points * length / resolved * law.normal_stiffness() / young};
  }

  double FaceFamily::compliance(const unsigned int axis, const double C_N,
                                const double C_T) const
  {
    const auto part = [](const double sum, const double C) {
      return sum > 0. ? sum / C : 0.;
    };
    return part(normal[axis], C_N) + part(shear[axis], C_T);
  }

  template <int dim>
  std::vector<FaceFamily>
  face_families(const SceneInput &input,
                const Discretization<dim> &discretization, const double volume,
                const Communicator &communicator)
  {
    const auto &points = discretization.points();
    std::vector<FaceFamily> families(input.interfaces.size());
    // block x material: 1 where they touch
    std::vector<char> touches(families.size() * input.materials.size(), 0);
    for (const auto &face : points.faces) {
      const PointOrigin origin = discretization.origins()[face.first];
      if (origin.kind != PointOrigin::Kind::interface)
        continue;
      for (const int body : face.bodies)
        if (body >= 0)
          touches[origin.block * input.materials.size() +
                  discretization.cells().body_class(unsigned(body)).material] =
              1;
      double size = 0.;
      for (unsigned int i = face.first; i < face.first + face.count; ++i)
        size += points.measure(i);
      double &longest = families[origin.block].longest;
      longest = std::max(longest, dim == 2 ? size : std::sqrt(size));
    }
    for (FaceFamily &family : families)
      family.longest = communicator.max(family.longest);
    for (unsigned int block = 0; block < families.size(); ++block)
      for (unsigned int m = 0; m < input.materials.size(); ++m)
        if (communicator.any(touches[block * input.materials.size() + m] !=
                             0) &&
            !input.materials[m].rigid)
          families[block].materials.push_back(m);
    constexpr unsigned int n_rows = 1 + 2 * dim;
    for (unsigned int block = 0; block < families.size(); ++block) {
      std::vector<double> terms(n_rows * points.n_owned, 0.);
      for (std::size_t i = 0; i < points.n_owned; ++i) {
        const PointOrigin origin = discretization.origins()[i];
        if (origin.kind != PointOrigin::Kind::interface ||
            origin.block != block)
          continue;
        const double share = points.measure(i) / volume;
        terms[i] = share;
        for (unsigned int a = 0; a < dim; ++a) {
          const double n = points.axes(i)[a], square = n * n;
          terms[(1 + a) * points.n_owned + i] = share * square * square;
          terms[(1 + dim + a) * points.n_owned + i] =
              share * square * (1. - square);
        }
      }
      std::array<double, n_rows> sums;
      for (unsigned int r = 0; r < n_rows; ++r)
        sums[r] =
            communicator.sum(terms.data() + r * points.n_owned, points.n_owned);
      families[block].density = sums[0];
      for (unsigned int a = 0; a < dim; ++a) {
        families[block].normal[a] = sums[1 + a];
        // what round-off leaves of faces along the axes is none
        families[block].shear[a] =
            sums[1 + dim + a] > 1e-14 * sums[0] ? sums[1 + dim + a] : 0.;
      }
    }
    return families;
  }

  std::array<double, 2> intact_stiffness(const InterfaceInput &block)
  {
    if (block.law && !block.law->extrinsic())
      return {{block.law->normal_stiffness(),
               block.law->normal_stiffness() * block.law->stiffness_ratio()}};
    if (block.law_name == "elastic")
      return {{block.normal_stiffness, block.tangential_stiffness}};
    constexpr double rigid = std::numeric_limits<double>::infinity();
    return {{rigid, rigid}};
  }

  template <int dim>
  State all_softening(const State &state,
                      const Discretization<dim> &discretization,
                      const SceneInput &input, const int block)
  {
    State result = state;
    for (std::size_t i = 0; i < discretization.points().n_points; ++i) {
      const PointOrigin origin = discretization.origins()[i];
      const bool softens = origin.kind == PointOrigin::Kind::interface &&
                           (block < 0 || int(origin.block) == block) &&
                           input.interfaces[origin.block].law &&
                           state.kind[i] != PointKind::free;
      if (softens) {
        result.kind[i] = PointKind::cohesive;
        result.opening_max[i] = std::numeric_limits<double>::infinity();
      } else if (result.kind[i] == PointKind::cohesive)
        result.kind[i] = PointKind::free;
    }
    return result;
  }

  template <int dim>
  double contraction_number(const SceneInput &input,
                            const OneStepProblem<dim> &problem,
                            const State &softening,
                            DelassusOperator<dim> &delassus, const double h)
  {
    const auto &points = delassus.points();
    const double chi =
        input.time.cohesion_rule == CohesionRule::exact ? 0.5 : 1.;
    std::vector<double> scale(points.n_points * dim, 0.), x(scale), y(scale);
    for (std::size_t i = 0; i < points.n_points; ++i) {
      if (softening.kind[i] != PointKind::cohesive)
        continue;
      const double slope = problem.interactions[problem.interaction[i]]
                               .law->steepest_softening();
      if (!std::isfinite(slope))
        continue;
      const double scaled = // of a T(a d / g)
          problem.strength_factor[i] * problem.opening_factor[i] * slope;
      for (unsigned int c = 0; c < dim; ++c) {
        scale[i * dim + c] =
            h * std::sqrt(input.time.theta * chi * scaled * points.weight[i]);
        // any direction, the same on both ranks of a shared face
        const auto &face = points.faces[points.face_of[i]];
        x[i * dim + c] =
            std::sin(double(face.key % 10007) + (i - face.first) + 2.5 * c);
      }
    }
    delassus.reinit(h, input.time.bulk_theta());
    const std::size_t n_owned = points.n_owned * dim;
    double result = 0.;
    for (unsigned int k = 0; k < 300; ++k) {
      const double norm =
          std::sqrt(delassus.communicator().dot(x.data(), x.data(), n_owned));
      if (norm == 0.)
        return 0.;
      for (std::size_t j = 0; j < x.size(); ++j)
        x[j] *= scale[j] / norm;
      delassus.apply_delassus(x.data(), y.data());
      for (std::size_t j = 0; j < x.size(); ++j)
        y[j] *= scale[j];
      const double value =
          std::sqrt(delassus.communicator().dot(y.data(), y.data(), n_owned));
      x.swap(y);
      if (k > 20 && value <= result * (1. + 1e-5))
        return value;
      result = value;
    }
    return result;
  }

  template std::vector<FaceFamily> face_families<2>(const SceneInput &,
                                                    const Discretization<2> &,
                                                    double,
                                                    const Communicator &);
  template std::vector<FaceFamily> face_families<3>(const SceneInput &,
                                                    const Discretization<3> &,
                                                    double,
                                                    const Communicator &);
  template State all_softening<2>(const State &, const Discretization<2> &,
                                  const SceneInput &, int);
  template State all_softening<3>(const State &, const Discretization<3> &,
                                  const SceneInput &, int);
  template double contraction_number<2>(const SceneInput &,
                                        const OneStepProblem<2> &,
                                        const State &, DelassusOperator<2> &,
                                        double);
  template double contraction_number<3>(const SceneInput &,
                                        const OneStepProblem<3> &,
                                        const State &, DelassusOperator<3> &,
                                        double);
} // namespace nsfd
