#include "bisected_mesh.h"

#include "adaptivity/bisection_transfer.h"
#include "adaptivity/halves_to_join.h"
#include "discretization/body_frequency.h"
#include "discretization/cells.h"
#include "mesh/level_mesh.h"

#include "nsfd/core/archive.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace nsfd
{
  using namespace dealii;

  namespace
  {
    /// steps between two looks: a wave passes a few of the smallest cells
    constexpr unsigned int between_looks = 4;

    std::vector<unsigned int> materials_of(const SceneInput &input,
                                           const Model<2> &model)
    {
      std::vector<std::string> problems, warnings; // found before
      return material_indices<2>(input, *model.groups, *model.triangulation,
                                 problems, warnings);
    }

    Bisection cells_of(const Model<2> &model)
    {
      return Bisection(active_level<2>(*model.triangulation, true));
    }

    std::vector<unsigned int> of_cells(const std::vector<unsigned int> &first,
                                       const Bisection &cells)
    {
      std::vector<unsigned int> result;
      result.reserve(cells.cells().size());
      for (const auto &cell : cells.cells())
        result.push_back(first[cell.first]);
      return result;
    }

    void fill_with(const Bisection &cells, Triangulation<2> &triangulation)
    {
      const auto mesh = cells.mesh();
      triangulation.clear();
      triangulation.create_triangulation(mesh.vertices, mesh.cells,
                                         mesh.boundary);
    }

    /** The points, and those around them that fronts will get to: meshes change
        seldom. */
    std::vector<MeshView::Point>
    and_ahead(const double ahead, const std::vector<MeshView::Point> &points)
    {
      constexpr unsigned int n = 12;
      constexpr double pi = 3.14159265358979323846;
      auto result = points;
      for (const auto &point : points)
        for (unsigned int k = 0; k < n && ahead > 0.; ++k) {
          auto &one = result.emplace_back(point);
          one.position[0] += ahead * point.zone * std::cos(2. * pi * k / n);
          one.position[1] += ahead * point.zone * std::sin(2. * pi * k / n);
        }
      return result;
    }
  } // namespace

  std::vector<Point<2>> middles_of(const Bisection &cells,
                                   const Triangulation<2> &triangulation)
  {
    std::vector<Point<2>> result(triangulation.n_raw_faces());
    for (const auto &cell : triangulation.active_cell_iterators()) {
      const auto &v = cells.cells()[cell->id().get_coarse_cell_id()].vertices;
      for (unsigned int f = 0; f < 3; ++f) {
        const auto [a, b] = cells.whole_edge(v[f], v[(f + 1) % 3]);
        result[std::size_t(cell->face(f)->index())] =
            cells.vertex(a) + (cells.vertex(b) - cells.vertex(a)) / 2.;
      }
    }
    return result;
  }

  BisectedMesh::BisectedMesh(const SceneInput &input,
                             const Communicator &communicator, Model<2> &model)
      : input_(input), communicator_(communicator), model_(model),
        materials_(materials_of(input, model)), cells_(cells_of(model)),
        fronts_(input, model)
  {
  }

  BisectedMesh::~BisectedMesh() = default;

  State BisectedMesh::start()
  {
    refine({});
    cells_.settle();
    build();
    return model_.initial_state();
  }

  State BisectedMesh::restore(const std::vector<std::uint32_t> &ids)
  {
    cells_.restore(ids);
    view_.reset();
    build();
    return model_.initial_state();
  }

  void BisectedMesh::serialize(Archive &archive)
  {
    const Archive::Part part(archive, "bisected_mesh");
    const auto ids = cells_.ids();
    std::vector<double> cells(ids.begin(), ids.end());
    archive.common("cells", cells);
    archive.numbers("sums", changes_, largest_cells_, cells_sum_, steps_, lost_,
                    worst_, n_joined_);
  }

  /** All parts on the present cells. */
  void BisectedMesh::build()
  {
    fill_with(cells_, *model_.triangulation);
    model_.groups->set_middles(middles_of(cells_, *model_.triangulation));
    model_.rebuild_joined(input_, communicator_, of_cells(materials_, cells_));
    fronts_.mesh_changed();
    largest_cells_ =
        std::max<unsigned long long>(largest_cells_, cells_.cells().size());
  }

  bool BisectedMesh::refine(std::vector<MeshView::Point> points)
  {
    constexpr double round_off = 1. + 1e-6; // sizes were halved and compared
    const auto &adaptivity = *input_.adaptivity;
    const unsigned int deepest = 2 * adaptivity.levels;
    bool any = false;
    for (;;) {
      if (!view_)
        view_ = std::make_unique<LeafView>(cells_, deepest);
      view_->set_points(points);
      const auto &bodies = view_->bodies();
      std::vector<double> size(bodies.size(),
                               std::numeric_limits<double>::max());
      for (const auto &indicator : adaptivity.indicators)
        indicator->limit(*view_, size);
      std::vector<char> marked(cells_.cells().size(), 0);
      bool more = false;
      for (std::size_t b = 0; b < size.size(); ++b)
        if (bodies[b].size > size[b] * round_off) {
          marked[view_->cell(b)] = 1;
          more = true;
        }
      if (!more || !cells_.refine(marked, deepest))
        return any;
      view_.reset();
      if (!any)
        points = and_ahead(adaptivity.ahead, points);
      any = true;
    }
  }

  void BisectedMesh::count_step()
  {
    ++steps_;
    cells_sum_ += double(cells_.cells().size());
  }

  bool BisectedMesh::is_due(const State &state) const
  {
    return state.step % between_looks == 0;
  }

  bool BisectedMesh::accept(State &state)
  {
    count_step();
    if (!is_due(state))
      return false;
    const auto fronts = fronts_.new_ones(state.last_step);
    if (fronts.empty() || !refine(fronts))
      return false;
    change(state);
    return true;
  }

  /** Halves that are smaller than indicators ask for, and further from the
      present fronts than these would be refined. */
  std::vector<Bisection::Family> BisectedMesh::not_wanted(const double h) const
  {
    const auto points = fronts_.all(h);
    LeafView view(cells_, Bisection::none);
    view.set_points(and_ahead(input_.adaptivity->ahead, points));
    std::vector<double> size(view.bodies().size(),
                             std::numeric_limits<double>::max());
    for (const auto &indicator : input_.adaptivity->indicators)
      indicator->limit(view, size);
    auto families = cells_.families();
    const auto is_wanted = [&](const Bisection::Family &family) {
      for (const auto &[first, second] : family.pairs) {
        if (first == Bisection::none)
          continue;
        const double whole = cells_.longest_edge(cells_.joined(first, second));
        if (size[first] < whole || size[second] < whole)
          return true;
      }
      return false;
    };
    families.erase(std::remove_if(families.begin(), families.end(), is_wanted),
                   families.end());
    return families;
  }

  void BisectedMesh::change(State &state)
  {
    model_.leapfrog->show(state);
    const double before = kinetic_energy(state);
    // of the old cells: these are kept by the new ones
    BisectionTransfer transfer(cells_, *model_.discretization,
                               model_.leapfrog->parts().mesh);
    model_.leapfrog->serialize(transfer.old_parts());
    HalvesToJoin::Plan plan;
    if (input_.adaptivity->coarsen_every > 0 && state.last_step > 0.)
      plan =
          HalvesToJoin(cells_, *model_.discretization,
                       model_.leapfrog->parts().mesh, state)
              .plan(not_wanted(state.last_step), transfer.front_viscosities());
    if (!plan.families.empty())
      view_.reset(); // it numbers the cells
    cells_.join(plan.families);
    n_joined_ += plan.families.size();
    build();
    transfer.set_mesh(*model_.discretization, model_.leapfrog->parts().mesh);
    state = transfer.state(state);
    for (std::size_t k = 0; !plan.moved.empty() && k < cells_.cells().size();
         ++k)
      for (unsigned int i = 0; i < 3; ++i) {
        const auto moved = plan.moved.find(cells_.cells()[k].vertices[i]);
        for (unsigned int c = 0; moved != plan.moved.end() && c < 2; ++c)
          state.displacement[6 * k + 2 * i + c] += moved->second[c];
      }
    const State given = plan.families.empty() ? State() : state;
    model_.leapfrog->resume_from(state);
    if (!plan.families.empty()) {
      model_.leapfrog->show(state);
      transfer.set_motion(*model_.discretization, given, state);
    }
    model_.leapfrog->serialize(transfer.new_parts());
    model_.leapfrog->show(state);
    cells_.settle();
    const double of_motion = kinetic_energy(state) - before + plan.motion,
                 lost = -of_motion - plan.elastic;
    state.energy.kinetic += of_motion;
    state.energy.elastic += plan.elastic;
    state.energy.numerical += lost;
    lost_ += lost;
    worst_ = std::max(worst_, lost / state.largest_energy);
    ++changes_;
  }

  double BisectedMesh::kinetic_energy(const State &state) const
  {
    const auto &mesh = model_.leapfrog->parts().mesh;
    std::vector<double> terms(state.velocity.size());
    for (std::size_t k = 0; k < terms.size(); ++k)
      terms[k] = mesh.mass(k / 2) * state.velocity[k] * state.velocity[k] / 2.;
    return communicator_.sum(terms);
  }

  void
  BisectedMesh::fill_counters(std::map<std::string, double> &counters) const
  {
    counters["mesh_changes"] = changes_;
    counters["joined_halves"] = double(n_joined_);
    counters["largest_cells"] = double(largest_cells_);
    counters["mean_cells"] = cells_sum_ / std::max(1., steps_);
    counters["mesh_change_energy"] = lost_;
    counters["mesh_change_energy_worst"] = worst_;
  }

  namespace
  {
    /** Over the descendants of a cell: the highest frequency at @p deepest
        bisections or less. All four shapes are among those of the first five,
        and come again at half of the size after two more. */
    void look_at_halves(const Cells<2> &cells, const std::size_t body,
                        const std::vector<Point<2>> &x,
                        const unsigned int level, const unsigned int deepest,
                        double &highest)
    {
      const auto of_half = cells.shape(body, x);
      const auto &shape = *of_half;
      const double scale = std::ldexp(1., int((deepest - level) / 2));
      if (scale * frequency_bound(shape) > highest)
        highest = std::max(highest, scale * highest_frequency(shape));
      if (level == std::min(5u, deepest))
        return;
      const Point<2> m = x[1] + (x[2] - x[1]) / 2.;
      look_at_halves(cells, body, {m, x[0], x[1]}, level + 1, deepest, highest);
      look_at_halves(cells, body, {m, x[2], x[0]}, level + 1, deepest, highest);
    }
  } // namespace

  double longest_bisected_step(const SceneInput &input, const Model<2> &model)
  {
    const Bisection mesh = cells_of(model);
    const auto &cells = model.discretization->cells();
    double highest = 0.;
    for (std::size_t b = 0; b < cells.bodies.size(); ++b) {
      std::vector<Point<2>> x;
      for (const unsigned int v : mesh.cells()[b].vertices)
        x.push_back(mesh.vertex(v));
      look_at_halves(cells, b, x, 0, 2 * input.adaptivity->levels, highest);
    }
    return longest_step(highest, input.front_viscosity());
  }
} // namespace nsfd
