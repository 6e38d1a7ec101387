#pragma once

#include "node_stars.h"
#include "one_point.h"

#include "nonsmooth/node/node_solver.h"

#include <numeric>

// Stars of cells separated by faces that carry a law: random groups, loads and
// histories, and the steps of a leapfrog on them.

namespace node_test
{
  using namespace nsfd;
  using point_law_test::range_of;

  /** What a run is like; all others are drawn. */
  struct Setting {
    std::shared_ptr<const CohesiveLaw> law;
    double friction = 0.;
    double joined = 0.;   ///< share of the faces that do not part
    double supports = 0.; ///< share of the groups with prescribed axes
    double broken = 0.;   ///< share of the points that start without cohesion
    double loaded = 0.;   ///< share of those that start with a history
    double contraction = 0.5; ///< h^2 w (1/m_a + 1/m_b) max |R'|
    int obstacles = 0;
    bool plateau = false, mean_sliding = false, two_sided = false;
  };

  /** What a solver is given, and what it gives. */
  template <int dim>
  struct NodeData {
    OneStepProblem<dim> problem;
    NodeProblem<dim> node;
    std::vector<double> frames, impulses;
    std::vector<LocalSolution<dim>> solutions;
    double h = 0.;

    Vec<dim> relative(const std::size_t i,
                      const std::vector<Vec<dim>> &of_groups) const
    {
      Vec<dim> d{}, result{};
      const auto &groups = node.points[i].groups;
      for (int s = 0; s < 2; ++s)
        if (groups[s] >= 0)
          for (int c = 0; c < dim; ++c)
            d[c] += (s == 0 ? -1. : 1.) * of_groups[groups[s]][c];
      for (int r = 0; r < dim; ++r)
        for (int c = 0; c < dim; ++c)
          result[r] += frames[(i * dim + r) * dim + c] * d[c];
      return result;
    }
  };

  /** A star of groups that moves by the leapfrog; the forces are drawn. */
  template <int dim>
  class NodeRun : public NodeData<dim>
  {
  public:
    using NodeData<dim>::problem, NodeData<dim>::node, NodeData<dim>::frames,
        NodeData<dim>::impulses, NodeData<dim>::solutions, NodeData<dim>::h,
        NodeData<dim>::relative;
    std::vector<Vec<dim>> velocity, old_velocity; ///< of the groups
    std::vector<Vec<dim>> position, offset;
    std::vector<double> mass;

    NodeRun(const Setting &setting, const std::uint64_t seed)
        : random(seed), setting_(setting)
    {
      const Star<dim> star = random_star<dim>(random);
      const int n_cells = star.volume.size();
      std::vector<int> group(n_cells);
      std::iota(group.begin(), group.end(), 0);
      for (const auto &face : star.faces)
        if (random() < setting.joined)
          std::replace(group.begin(), group.end(), int(group[face.cells[1]]),
                       int(group[face.cells[0]]));
      std::vector<int> index(n_cells, -1);
      for (int c = 0; c < n_cells; ++c) {
        int &g = index[group[c]];
        if (g < 0) {
          g = mass.size();
          mass.push_back(0.);
          centre_.emplace_back();
          centre_.back().fill(0.);
        }
        mass[g] += star.volume[c];
        for (int k = 0; k < dim; ++k)
          centre_[g][k] += star.volume[c] * star.centre[c][k];
      }
      const double spread = random.log(1., 10.);
      for (std::size_t g = 0; g < mass.size(); ++g) {
        for (double &x : centre_[g])
          x /= mass[g];
        mass[g] *= random.log(1. / spread, spread);
      }
      for (const auto &face : star.faces) {
        const int a = index[group[face.cells[0]]],
                  b = index[group[face.cells[1]]];
        if (a != b)
          add_point({{a, b}}, face.normal, face.area / dim);
      }
      for (int k = 0; k < setting.obstacles; ++k) {
        Vec<dim> n;
        for (double &x : n)
          x = random(-1., 1.);
        add_point({{-1, random.below(mass.size())}}, unit<dim>(n), 0.3);
        obstacle_.back() = 1;
      }
      set_masses();
      set_problem();
    }

    std::size_t n_points() const { return areas_.size(); }
    const CohesiveLaw &law() const { return *setting_.law; }

    /** The problem of the next step, without its impulses. */
    void prepare()
    {
      const std::size_t n = n_points();
      if (step_ % 30 == 0)
        for (auto &row : gradient_)
          for (double &x : row)
            x = speed_ * random(-1., 1.) * (step_ == 0 ? 1. : random(0., 3.));
      if (step_ == 0)
        for (int c = 0; c < dim; ++c) // first pulled
          gradient_[c][c] = speed_ * random(0., 2.);
      ++step_;
      old_velocity = velocity;
      node.velocity = velocity;
      const double kick = random() < 0.1 ? random.log(0.1, 10.) : 0.;
      for (std::size_t g = 0; g < mass.size(); ++g)
        for (int c = 0; c < dim; ++c) {
          const double field = dot<dim>(gradient_[c], centre_[g]);
          double &v = node.velocity[g][c];
          if (node.inverse_mass[g][c] == 0.)
            v = velocity[g][c] = dot<dim>(gradient_[c], centre_[0]);
          else
            v += rate_ * (field - v) + kick * speed_ * random(-1., 1.);
        }
      for (std::size_t i = 0; i < n; ++i) {
        const Vec<dim> u = jump(i, position), U = relative(i, old_velocity);
        // as a step does it: not where it rests
        const bool mean =
            setting_.mean_sliding && std::sqrt(dot<dim>(U, U)) > 1e-6 * speed_;
        for (int c = 0; c < dim; ++c) {
          problem.jump_old[i * dim + c] = old_jump_[i][c];
          problem.jump_free[i * dim + c] = u[c];
          problem.sliding_offset[i * dim + c] = mean && c > 0 ? U[c] : 0.;
          old_jump_[i][c] = u[c];
        }
        problem.contact[i] = problem.compression_stiffness[i] == 0.;
        problem.target[i] = -std::max(0., u[0]) / h;
      }
    }

    /** After the solve: moves, and what the points keep of it. */
    void accept()
    {
      velocity = node.velocity;
      for (std::size_t g = 0; g < mass.size(); ++g)
        for (int c = 0; c < dim; ++c)
          position[g][c] += h * velocity[g][c];
      for (std::size_t i = 0; i < n_points(); ++i) {
        const auto &s = solutions[i];
        const auto e =
            point_energies<dim>(problem, i, relative(i, velocity), s.frozen);
        problem.opening_max[i] = e.history.opening;
        if (!problem.slip_max.empty())
          problem.slip_max[i] = e.history.slip;
        if (problem.kind[i] == PointKind::rigid && s.damages)
          problem.kind[i] = PointKind::cohesive;
        if (problem.kind[i] == PointKind::cohesive) {
          if (e.beta < 1.)
            problem.compression_stiffness[i] = 0.;
          if (e.beta <= 0.)
            problem.kind[i] = PointKind::free;
        }
      }
    }

    Random random;

  private:
    Setting setting_;
    std::vector<Vec<dim>> centre_, old_jump_;
    std::vector<double> areas_;
    std::vector<char> obstacle_;
    std::array<Vec<dim>, dim> gradient_{};
    double speed_ = 0., rate_ = 0.;
    int step_ = 0;

    void add_point(const std::array<int, 2> &groups, const Vec<dim> &normal,
                   const double weight)
    {
      node.points.push_back({node.points.size(), groups});
      const auto frame = frame_of<dim>(normal);
      frames.insert(frames.end(), frame.begin(), frame.end());
      areas_.push_back(weight);
      obstacle_.push_back(0);
    }

    void set_masses()
    {
      node.inverse_mass.resize(mass.size());
      for (std::size_t g = 0; g < mass.size(); ++g)
        node.inverse_mass[g].fill(1. / mass[g]);
      const int axes = 1 + random.below(1 << dim);
      for (auto &inverse : node.inverse_mass)
        if (random() < setting_.supports)
          for (int c = 0; c < dim; ++c)
            if (axes & (1 << c))
              inverse[c] = 0.;
    }

    Vec<dim> jump(const std::size_t i, const std::vector<Vec<dim>> &q) const
    {
      Vec<dim> u = relative(i, q);
      for (int c = 0; c < dim; ++c)
        u[c] += offset[i][c];
      return u;
    }

    void set_problem()
    {
      const std::size_t n = n_points();
      const double range = range_of(law()), strength = law().strength();
      const double one_way = std::isfinite(law().steepest_softening())
                                 ? law().steepest_softening()
                                 : strength / range,
                   shear = law().stiffness_ratio();
      // the largest eigenvalue of the softening in opening and slip
      const double slope =
          one_way * (law().adds_openings() ? 1. + shear : std::max(1., shear));
      // a bound of the largest eigenvalue of w W
      std::vector<double> sum(mass.size());
      for (std::size_t i = 0; i < n; ++i)
        for (const int g : node.points[i].groups)
          if (g >= 0)
            sum[g] += areas_[i] / mass[g];
      double most = 1e-300;
      for (const auto &p : node.points) {
        double w = 0.;
        for (const int g : p.groups)
          w += g < 0 ? 0. : sum[g];
        most = std::max(most, w);
      }
      h = std::sqrt(setting_.contraction / (most * slope));
      speed_ = range / h / random.log(3., 300.);
      rate_ = random.log(0.01, 1.);

      resize(problem, n);
      problem.n_owned = n;
      problem.time_step = 2. * h;
      problem.theta = 0.5;
      problem.rule = CohesionRule::exact;
      Interaction interaction =
          interaction_of(setting_.law, setting_.friction, random.below(3));
      interaction.plateau = setting_.plateau;
      problem.interactions = {interaction,
                              point_law_test::contact_only(setting_.friction)};
      if (law().mixed())
        problem.slip_max.assign(n, 0.);
      position.assign(mass.size(), Vec<dim>{});
      velocity = old_velocity = position;
      offset.assign(n, Vec<dim>{});
      old_jump_ = offset;
      impulses.assign(n * dim, 0.);
      solutions.assign(n, {});
      for (std::size_t i = 0; i < n; ++i)
        set_point(i, range);
    }

    void set_point(const std::size_t i, const double range)
    {
      problem.weight[i] = areas_[i] / 2.;
      problem.strength_factor[i] = random(0.8, 1.2);
      problem.opening_factor[i] = problem.strength_factor[i];
      problem.kind[i] = point_law_test::initial_kind(law());
      const double l = problem.opening_factor[i];
      if (!law().extrinsic()) {
        problem.opening_max[i] = law().elastic_limit() / l;
        if (setting_.two_sided)
          problem.compression_stiffness[i] =
              problem.strength_factor[i] * l * law().normal_stiffness();
      }
      if (obstacle_[i] || random() < setting_.broken) {
        problem.kind[i] = PointKind::free;
        problem.compression_stiffness[i] = 0.;
        problem.interaction[i] = obstacle_[i];
        if (random() < 0.5)
          offset[i][0] = range * random.log(1e-4, 1.);
      } else if (random() < setting_.loaded) {
        problem.kind[i] = PointKind::cohesive;
        problem.compression_stiffness[i] = 0.;
        const double d = range / l * random.log(1e-3, 1.);
        problem.opening_max[i] = std::max(problem.opening_max[i], d);
        if (!problem.slip_max.empty())
          problem.slip_max[i] = d * random();
        // no farther than the largest opening, in which slip may count more
        const double slip = d / std::max(1., std::sqrt(law().shear_weight()));
        for (int c = 0; c < dim; ++c)
          offset[i][c] = random() < 0.3
                             ? 0.
                             : 0.5 * (c ? slip : d) * random(c ? -1. : 0., 1.);
      }
      old_jump_[i] = offset[i];
    }
  };

  /** | P - P* |_R / | P |_R against @p part of R, independent of the solver. */
  template <int dim>
  double natural_map(const NodeData<dim> &run, const double part = 1.)
  {
    double error = 0., size = 0.;
    for (const auto &p : run.node.points) {
      const std::size_t i = p.point;
      Vec<dim> w{};
      double speed = 0.;
      for (const int g : p.groups)
        for (int c = 0; c < dim && g >= 0; ++c) {
          w[c] += run.node.inverse_mass[g][c];
          speed += std::abs(run.node.velocity[g][c]);
        }
      if (run.problem.kind[i] != PointKind::free)
        for (int c = 0; c < dim; ++c)
          speed += std::abs(run.problem.jump_free[i * dim + c]) / run.h;
      double R = *std::max_element(w.begin(), w.end());
      if (R == 0.)
        R = 1.;
      R *= part;
      Vec<dim> local = run.relative(i, run.node.velocity);
      for (int c = 0; c < dim; ++c)
        local[c] -= R * run.impulses[i * dim + c];
      const auto s =
          solve_point<dim>(run.problem, i, local, R, R, run.solutions[i].reach);
      for (int c = 0; c < dim; ++c) {
        const double P = run.impulses[i * dim + c], d = P - s.impulse[c];
        error += R * d * d;
        size += R * P * P;
      }
      size += 1.6e-5 * speed * speed / R; // round-off of free flight
    }
    return std::sqrt(error / (size + 1e-300));
  }

  /** The setting of run @p r of a law: one of each kind in every dozen. */
  inline Setting setting_of(const int r, std::shared_ptr<const CohesiveLaw> law,
                            const double friction, const double most = 1.)
  {
    Random random(1000 * r + 7);
    Setting s;
    s.law = std::move(law);
    s.friction = friction;
    s.joined = (r % 3) * 0.3;
    s.supports = r % 4 == 3 ? 0.3 : 0.;
    s.broken = r % 5 == 4 ? 0.5 : 0.;
    s.loaded = r % 7 > 4 ? 0.5 : 0.;
    s.contraction = random.log(1e-3, most);
    s.obstacles = r % 6 == 5 && s.supports == 0. ? 2 : 0;
    s.mean_sliding = r % 2;
    s.two_sided = r % 4 > 1;
    return s;
  }
} // namespace node_test
