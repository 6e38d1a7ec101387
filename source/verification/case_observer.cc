#include "case_observer.h"

#include "bodies/cell_stresses.h"
#include "core/gather.h"
#include "discretization/cells.h"
#include "postprocess/face_pieces.h"

#include "nsfd/core/archive.h"
#include "nsfd/scene/scene_input.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <stdexcept>
#include <type_traits>

namespace nsfd
{
  namespace
  {
    double relative(const double error, const double reference)
    {
      return reference > 0. ? error / reference : error;
    }
  } // namespace

  template <int dim>
  CaseObserver<dim>::CaseObserver(VerificationCase &verification,
                                  const TimeInput &time,
                                  const Discretization<dim> &discretization,
                                  const Communicator &communicator)
      : case_(verification), time_(time), discretization_(discretization),
        communicator_(communicator)
  {
  }

  template <int dim>
  bool CaseObserver<dim>::wants_states() const
  {
    const auto &materials = discretization_.input().materials;
    return case_.wants_cells() || case_.wants_opening() ||
           std::any_of(materials.begin(), materials.end(),
                       [](const MaterialInput &m) { return m.rigid; });
  }

  template <int dim>
  void CaseObserver<dim>::mesh_changed(const State &start)
  {
    if (case_.wants_broken_points())
      first_beta_ = start.beta;
  }

  template <int dim>
  void
  CaseObserver<dim>::observe(const State &state, const HistoryRow &row,
                             const std::vector<ObservableRecord> *observables)
  {
    StepView view;
    view.observables = observables;
    view.time = state.time;
    view.time_step = row.time_step;
    time_step_ = row.time_step;
    if (row.step == 0 && case_.wants_broken_points())
      first_beta_ = state.beta;
    view.row = &row;
    std::vector<CellState> cells;
    if (case_.wants_cells()) {
      cells = gather_cells(state);
      view.cells = &cells;
    }
    if (case_.wants_opening())
      set_opening(state, view);
    if (!has_rigid_bodies_)
      has_rigid_bodies_ = communicator_.any(!state.rigid.empty());
    std::vector<RigidState> rigid_bodies;
    if (*has_rigid_bodies_) {
      for (std::size_t b = 0; b < state.rigid.size() / 13; ++b)
        rigid_bodies.push_back(rigid_state(&state.rigid[13 * b]));
    }
    view.rigid_bodies = &rigid_bodies;
    case_.observe(view);
  }

  template <int dim>
  void CaseObserver<dim>::serialize(Archive &archive)
  {
    const Archive::Part part(archive, "verification");
    archive.numbers("time_step", time_step_);
    archive.points("first_beta", first_beta_);
    case_.serialize(archive);
  }

  template <int dim>
  void CaseObserver<dim>::set_opening(const State &state, StepView &view) const
  {
    const auto &points = discretization_.points();
    const std::size_t n = points.n_owned;
    std::vector<double> terms(3 * n, 0.);
    for (std::size_t i = 0; i < n; ++i)
      if (discretization_.origins()[i].kind == PointOrigin::Kind::obstacle) {
        terms[i] = points.weight[i];
        terms[n + i] = points.weight[i] * state.jump[i * dim];
        terms[2 * n + i] = points.weight[i] * state.relative_velocity[i * dim];
      }
    const auto s = communicator_.sums(terms.data(), 3, n);
    view.opening = relative(s[1], s[0]);
    view.opening_rate = relative(s[2], s[0]);
  }

  template <int dim>
  void CaseObserver<dim>::finish(const State &state,
                                 std::map<std::string, double> &errors)
  {
    if (case_.has_fields())
      field_errors(state, errors);
    if (case_.has_jump() && case_.has_fields())
      face_errors(state, errors);
    if (case_.wants_broken_points())
      case_.see_broken_points(gather_broken(state));
    case_.finish(errors);
  }

  template <int dim>
  std::vector<CellState>
  CaseObserver<dim>::gather_cells(const State &state) const
  {
    // centre, u, v, stress, volume
    constexpr unsigned int width = 16;
    const std::size_t n = discretization_.bodies().size();
    std::vector<double> mine(n * width, 0.);
    for (std::size_t b = 0; b < n; ++b) {
      for (unsigned int c = 0; c < dim; ++c)
        mine[b * width + c] = discretization_.cells().centre(unsigned(b))[c];
      mine[b * width + 15] = discretization_.cells().volume(unsigned(b));
    }
    const auto add = [&](const unsigned int body, const unsigned int at,
                         const double share, const double *values,
                         const unsigned int count) {
      for (unsigned int c = 0; c < count; ++c)
        mine[body * width + at + c] += share * values[c];
    };
    CellStresses<dim> stresses(discretization_, state);
    discretization_.visit_quadrature(
        discretization_.to_nodal(state.displacement),
        [&](const unsigned int b, const dealii::Point<dim> &x, const double JxW,
            const double *value, const double *gradient) {
          const double share = JxW / discretization_.cells().volume(b);
          add(b, 3, share, value, dim);
          add(b, 9, share, stresses.visit(b, x, value, gradient).data(), 6);
        });
    const bool is_viscous = discretization_.input().has_viscous_bodies();
    discretization_.visit_quadrature(
        discretization_.to_nodal(state.velocity),
        [&](const unsigned int b, const dealii::Point<dim> &x, const double JxW,
            const double *value, const double *rate) {
          const double share = JxW / discretization_.cells().volume(b);
          add(b, 6, share, value, dim);
          if (is_viscous)
            add(b, 9, share,
                discretization_.viscous_stress(b, x, value, rate).data(), 6);
        });
    const std::vector<double> all = gather_all(communicator_, mine);
    std::vector<CellState> cells(all.size() / width);
    for (std::size_t k = 0; k < cells.size(); ++k) {
      const double *in = all.data() + k * width;
      CellState &cell = cells[k];
      std::copy_n(in, 3, cell.centre.begin());
      std::copy_n(in + 3, 3, cell.displacement.begin());
      std::copy_n(in + 6, 3, cell.velocity.begin());
      std::copy_n(in + 9, 6, cell.stress.begin());
      cell.volume = in[15];
    }
    // the numbers of cells depend on the ranks, their places do not
    std::sort(cells.begin(), cells.end(),
              [](const CellState &a, const CellState &b) {
                return a.centre < b.centre;
              });
    return cells;
  }

  template <int dim>
  std::vector<BrokenPoint>
  CaseObserver<dim>::gather_broken(const State &state) const
  {
    const auto &points = discretization_.points();
    std::vector<BrokenPoint> broken;
    for (const auto &face : points.faces) {
      if (face.boundary || face.first >= points.n_owned)
        continue;
      const auto pieces = pieces_of<dim>(points, face);
      for (unsigned int k = 0; k < face.count; ++k)
        if (state.beta[face.first + k] == 0. &&
            first_beta_[face.first + k] > 0.)
          broken.push_back(pieces[k]);
    }
    constexpr unsigned int width = sizeof(BrokenPoint) / sizeof(double);
    static_assert(std::is_trivially_copyable<BrokenPoint>::value &&
                      width * sizeof(double) == sizeof(BrokenPoint),
                  "a point travels as numbers");
    std::vector<double> mine(broken.size() * width);
    std::memcpy(mine.data(), broken.data(), mine.size() * sizeof(double));
    const auto all = gather_all(communicator_, mine);
    broken.resize(all.size() / width);
    std::memcpy(static_cast<void *>(broken.data()), all.data(),
                all.size() * sizeof(double));
    std::sort(broken.begin(), broken.end(),
              [](const BrokenPoint &a, const BrokenPoint &b) {
                return a.position < b.position;
              });
    return broken;
  }

  template <int dim>
  void
  CaseObserver<dim>::field_errors(const State &state,
                                  std::map<std::string, double> &errors) const
  {
    const std::size_t n = discretization_.bodies().size();
    // per body: error and reference of u (L2), v (L2, L1), stress (L2)
    std::vector<double> terms(8 * n, 0.);
    CellStresses<dim> stresses(discretization_, state);
    const auto visit = [&](const std::vector<double> &unknowns,
                           const bool velocity) {
      discretization_.visit_quadrature(
          discretization_.to_nodal(unknowns),
          [&](const unsigned int b, const dealii::Point<dim> &x,
              const double JxW, const double *value, const double *gradient) {
            std::array<double, 3> position{};
            for (unsigned int c = 0; c < dim; ++c)
              position[c] = x[c];
            const auto reference =
                velocity ? case_.velocity(position, state.time)
                         : case_.displacement(position, state.time);
            const unsigned int row = velocity ? 2 : 0;
            for (unsigned int c = 0; c < dim; ++c) {
              const double error = value[c] - reference[c];
              terms[row * n + b] += JxW * error * error;
              terms[(row + 1) * n + b] += JxW * reference[c] * reference[c];
              if (velocity) {
                terms[4 * n + b] += JxW * std::abs(error);
                terms[5 * n + b] += JxW * std::abs(reference[c]);
              }
            }
            if (!velocity && case_.has_stress()) {
              const auto sigma = stresses.visit(b, x, value, gradient);
              const auto known = case_.stress(position, state.time);
              for (unsigned int c = 0; c < 6; ++c) {
                terms[6 * n + b] +=
                    JxW * (sigma[c] - known[c]) * (sigma[c] - known[c]);
                terms[7 * n + b] += JxW * known[c] * known[c];
              }
            }
          });
    };
    visit(state.displacement, false);
    visit(state.velocity, true);
    const auto s = communicator_.sums(terms.data(), 8, n);
    errors["displacement_L2"] = std::sqrt(relative(s[0], s[1]));
    errors["velocity_L2"] = std::sqrt(relative(s[2], s[3]));
    errors["velocity_L1"] = relative(s[4], s[5]);
    if (case_.has_stress())
      errors["stress_L2"] = std::sqrt(relative(s[6], s[7]));
  }

  /**
   * Over the points of faces that can open: the jump, and the traction where
   * the stress is known, at the time at which the springs of the last step
   * pull (the middle by the exact rule).
   */
  template <int dim>
  void
  CaseObserver<dim>::face_errors(const State &state,
                                 std::map<std::string, double> &errors) const
  {
    const auto &points = discretization_.points();
    const std::size_t n = points.n_owned;
    std::vector<double> terms(4 * n, 0.);
    const bool at_middle =
        !time_.scheme.smooth && time_.cohesion_rule == CohesionRule::exact;
    const double mean_time = state.time - (at_middle ? time_step_ / 2. : 0.);
    for (std::size_t i = 0; i < n; ++i) {
      if (discretization_.origins()[i].kind != PointOrigin::Kind::interface ||
          state.kind[i] == PointKind::prescribed ||
          state.kind[i] == PointKind::bonded)
        continue;
      const double *Q = points.axes(i);
      std::array<double, 3> x{}, normal{};
      for (unsigned int c = 0; c < dim; ++c) {
        x[c] = points.position[i * dim + c];
        normal[c] = Q[c];
      }
      const auto jump = case_.jump(x, normal, state.time);
      std::array<double, 3> traction{};
      if (case_.has_stress()) {
        const auto s = case_.stress(x, mean_time);
        const double sigma[3][3] = {
            {s[0], s[3], s[4]}, {s[3], s[1], s[5]}, {s[4], s[5], s[2]}};
        for (unsigned int c = 0; c < dim; ++c)
          for (unsigned int d = 0; d < dim; ++d)
            traction[c] += sigma[c][d] * normal[d];
      }
      const double w = points.weight[i];
      for (unsigned int k = 0; k < dim; ++k) {
        double known_jump = 0., known_traction = 0.;
        for (unsigned int c = 0; c < dim; ++c) {
          known_jump += Q[k * dim + c] * jump[c];
          known_traction += Q[k * dim + c] * traction[c];
        }
        const double pull = -state.impulse[i * dim + k] / (w * time_step_);
        const double du = state.jump[i * dim + k] - known_jump,
                     dR = pull - known_traction;
        terms[i] += w * du * du;
        terms[n + i] += w * known_jump * known_jump;
        terms[2 * n + i] += w * dR * dR;
        terms[3 * n + i] += w * known_traction * known_traction;
      }
    }
    const auto s = communicator_.sums(terms.data(), 4, n);
    if (s[1] > 0.)
      errors["jump_L2"] = std::sqrt(s[0] / s[1]);
    if (case_.has_stress() && s[3] > 0. && time_step_ > 0.)
      errors["traction_L2"] = std::sqrt(s[2] / s[3]);
  }

  template class CaseObserver<2>;
  template class CaseObserver<3>;

  double StepView::observed(const std::string &name,
                            const std::string &column) const
  {
    if (observables)
      for (const ObservableRecord &record : *observables)
        for (std::size_t k = 0; k < record.columns.size(); ++k)
          if (record.name == name && record.columns[k].name == column)
            return k < record.last.size()
                       ? record.last[k]
                       : std::numeric_limits<double>::quiet_NaN();
    throw std::runtime_error(fmt::format(
        "Verification: the scene has no `Observable: {}` with a column {}",
        name, column));
  }
} // namespace nsfd
