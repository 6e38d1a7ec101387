#include "cells.h"

#include "absorbing_sides.h"

#include "mesh/owned_cells.h"

#include "nsfd/scene/scene_input.h"

#include <deal.II/fe/fe_dgq.h>
#include <deal.II/fe/fe_simplex_p.h>
#include <deal.II/grid/tria.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <tuple>

namespace nsfd
{
  using namespace dealii;

  namespace
  {
    /**
     * @p relative: corners from the first one on, as multiples of a power of
     * two, of which @p multiple is told. Returns its exponent.
     */
    template <int dim, typename Tell>
    int round_corners(const std::vector<Point<dim>> &corners, double &size,
                      std::vector<Point<dim>> &relative, const Tell &multiple)
    {
      size = 0.;
      for (const auto &corner : corners)
        for (unsigned int c = 0; c < dim; ++c)
          size = std::max(size, std::abs(corner[c] - corners[0][c]));
      int exponent;
      std::frexp(size, &exponent);
      const double unit = std::ldexp(1., exponent - 42);
      relative.resize(corners.size());
      for (unsigned int v = 0; v < corners.size(); ++v)
        for (unsigned int c = 0; c < dim; ++c) {
          const long long n =
              std::llround((corners[v][c] - corners[0][c]) / unit);
          multiple(n);
          relative[v][c] = double(n) * unit;
        }
      return exponent;
    }

    template <int dim>
    struct RoundedCorners {
      explicit RoundedCorners(const std::vector<Point<dim>> &corners) : key(2)
      {
        key[0] = static_cast<long long>(corners.size());
        key[1] = round_corners(corners, size, relative,
                               [&](const long long n) { key.push_back(n); });
      }

      /** Of an axisymmetric scene: rings of one radius are congruent. */
      void add_radius(const double of_corner)
      {
        const double unit = std::ldexp(1., int(key[1]) - 42);
        key.push_back(std::llround(of_corner / unit));
        corner_radius = double(key.back()) * unit;
      }

      double size = 0., corner_radius = 0.;
      std::vector<long long> key; ///< equal for congruent cells
      std::vector<Point<dim>> relative;
    };

    using GradedRange = std::array<LocalModuli, 2>;

    constexpr double infinity = std::numeric_limits<double>::infinity();
    constexpr GradedRange no_range = {{{infinity, infinity, infinity, {}},
                                       {-infinity, -infinity, -infinity, {}}}};

    bool has_orientation(const LocalModuli &local)
    {
      return std::all_of(
          local.orientation.begin(), local.orientation.end(),
          [](const double angle) { return std::isfinite(angle); });
    }

    /** The constants of a cell are used; false if they cannot be. */
    bool take(const MaterialInput &material, const LocalModuli &local,
              GradedRange &range)
    {
      bool possible = true;
      for (const auto member : {&LocalModuli::young, &LocalModuli::poisson,
                                &LocalModuli::density}) {
        const bool finite = std::isfinite(local.*member);
        const double value = finite ? local.*member : -infinity;
        range[0].*member = std::min(range[0].*member, value);
        range[1].*member = std::max(range[1].*member, value);
        possible = possible && finite;
      }
      return possible && has_orientation(local) && local.density > 0. &&
             (material.rigid || !material.is_isotropic() || local.young > 0.) &&
             local.poisson > -1. && local.poisson < 0.5;
    }

    /** What stands in for constants that end the run. */
    constexpr LocalModuli harmless = {1., 0., 1., {}};

    /** One entry if they are the same at all places. */
    template <int dim>
    std::vector<LocalModuli>
    moduli_of_cell(const MaterialInput &material,
                   const std::vector<Point<dim>> &places,
                   const Point<dim> &origin, const unsigned int id,
                   GradedRange &range, bool &is_oriented)
    {
      std::vector<LocalModuli> moduli;
      for (const auto &place : places) {
        const LocalModuli local =
            local_moduli<dim>(material, origin + Tensor<1, dim>(place), id);
        is_oriented = is_oriented && has_orientation(local);
        moduli.push_back(take(material, local, range) ? local : harmless);
      }
      const LocalModuli &first = moduli.front();
      if (std::all_of(moduli.begin(), moduli.end(),
                      [&](const LocalModuli &local) { return local == first; }))
        moduli.resize(1);
      return moduli;
    }

    /** Of cells that share their blocks. */
    std::vector<double> as_numbers(const std::vector<LocalModuli> &moduli)
    {
      std::vector<double> numbers;
      for (const LocalModuli &local : moduli) {
        numbers.insert(numbers.end(),
                       {local.young, local.poisson, local.density});
        numbers.insert(numbers.end(), local.orientation.begin(),
                       local.orientation.end());
      }
      return numbers;
    }

    /** Bit f: the cells behind face f are smaller. */
    template <typename Cell>
    unsigned int divided_faces(const Cell &cell)
    {
      unsigned int bits = 0;
      for (const unsigned int f : cell->face_indices())
        if (!cell->face(f)->at_boundary() && cell->face(f)->has_children())
          bits |= 1u << f;
      return bits;
    }
  } // namespace

  template <int dim>
  Cells<dim>::Cells(const Triangulation<dim> &triangulation,
                    const std::vector<unsigned int> &materials,
                    const SceneInput &input, const CellSet set,
                    const std::vector<AbsorbingFace> &absorbing)
  {
    const unsigned int degree = input.discretization.degree;
    if (triangulation.all_reference_cells_are_hyper_cube())
      element = std::make_unique<FE_DGQ<dim>>(degree);
    else
      element = std::make_unique<FE_SimplexDGP<dim>>(degree);
    builder_ = std::make_unique<ClassBuilder<dim>>(*element, input);
    const ClassBuilder<dim> &builder = *builder_;

    auto next_absorbing = absorbing.begin();
    // bit f: face f of a body absorbs; they come in the order of the bodies
    const auto absorbing_bits = [&](const std::size_t body) {
      unsigned int bits = 0;
      for (; next_absorbing != absorbing.end() && next_absorbing->body == body;
           ++next_absorbing)
        bits |= 1u << next_absorbing->face;
      return input.time.scheme.at_nodes ? 0 : bits;
    };

    using Form = std::pair<std::array<unsigned int, 2>, std::vector<long long>>;
    using Key = std::tuple<unsigned int, Form, std::vector<double>>;
    std::map<Key, unsigned int> class_by_key;
    std::map<Form, std::vector<Point<dim>>> places; // of graded materials
    std::vector<std::vector<LocalModuli>> constants;
    for (unsigned int m = 0; m < input.materials.size(); ++m) {
      const MaterialInput &material = input.materials[m];
      constants.push_back(
          {material.varies() ? LocalModuli() : local_moduli(material)});
      if (material.varies())
        graded.emplace(m, no_range);
    }
    first_node.push_back(0);
    bodies.first_dof.push_back(0);
    bodies.first_slot.push_back(0);
    const auto cells = cells_of(triangulation, set);
    corners.reserve(cells.size());
    global_cell.reserve(cells.size());
    cell_id.reserve(cells.size());
    bodies.class_of.reserve(cells.size());
    for (auto *first : {&first_node, &bodies.first_dof, &bodies.first_slot})
      first->reserve(cells.size() + 1);
    const auto add = [&](const auto &cell, const unsigned int k) {
      BodyClass &body = bodies.classes[k];
      body.bodies.push_back(unsigned(bodies.class_of.size()));
      bodies.class_of.push_back(k);
      bodies.first_dof.push_back(bodies.first_dof.back() + body.n_dofs);
      bodies.first_slot.push_back(bodies.first_slot.back() + body.n_slots);
      first_node.push_back(first_node.back() + shapes[k].n_nodes);
      global_cell.push_back(cell->global_active_cell_index());
      cell_id.push_back(cell->id().template to_binary<dim>());
    };
    // of cells without blocks all of a material are of one class
    std::map<std::pair<unsigned int, unsigned int>, unsigned int> class_of_kind;
    for (const auto &cell : cells) {
      const unsigned int material = materials[cell->active_cell_index()];
      auto &own_corners = corners.emplace_back();
      own_corners.reserve(cell->n_vertices());
      for (const unsigned int v : cell->vertex_indices())
        own_corners.push_back(cell->vertex(v));
      const bool varies = input.materials[material].varies();
      // of one material, and of one grain if there are some
      const std::pair<unsigned int, unsigned int> kind = {
          material, varies ? cell->material_id() : 0};
      if (builder.has_no_blocks()) {
        const auto found = class_of_kind.find(kind);
        if (found != class_of_kind.end()) {
          add(cell, found->second);
          continue;
        }
      }
      RoundedCorners<dim> rounded(own_corners);
      if (input.axisymmetric)
        rounded.add_radius(own_corners[0][0]);
      const unsigned int divided = divided_faces(cell),
                         absorbs = absorbing_bits(corners.size() - 1);
      const Form form = builder.has_no_blocks()
                            ? Form()
                            : Form({{divided, absorbs}}, rounded.key);
      std::vector<double> local; // empty where the material is not graded
      std::vector<LocalModuli> moduli;
      if (varies) {
        bool is_oriented = true;
        auto &of_form = places[form];
        if (of_form.empty())
          of_form = builder.moduli_places(cell->reference_cell(),
                                          rounded.relative, divided);
        moduli = moduli_of_cell<dim>(input.materials[material], of_form,
                                     own_corners[0], cell->material_id(),
                                     graded[material], is_oriented);
        if (!is_oriented)
          without_orientation.emplace(material, cell->material_id());
        local = as_numbers(moduli);
      }
      const auto [entry, is_new] = class_by_key.emplace(
          Key(material, form, local), unsigned(shapes.size()));
      const unsigned int k = entry->second;
      if (is_new) {
        builder.build(cell->reference_cell(), rounded.relative, rounded.size,
                      rounded.corner_radius, material, divided,
                      moduli.empty() ? constants[material] : moduli,
                      shapes.emplace_back(), bodies.classes.emplace_back());
        builder.add_absorbing(absorbs, shapes[k], bodies.classes[k]);
      }
      class_of_kind.emplace(kind, k);
      add(cell, k);
    }
    spare_shapes_.resize(shapes.size());
  }

  template <int dim>
  ShapeOfBody<dim> Cells<dim>::shape(const std::size_t body,
                                     const std::vector<Point<dim>> &at) const
  {
    const auto &of_class = class_shape(body);
    if (!differ())
      return ShapeOfBody<dim>(of_class);
    auto &spare = spare_shapes_[bodies.class_of[body]];
    std::unique_ptr<BodyShape<dim>> shape;
    if (spare.empty())
      shape = std::make_unique<BodyShape<dim>>(of_class);
    else {
      shape = std::move(spare.back());
      spare.pop_back();
    }
    double size;
    round_corners(at, size, shape->corners, [](long long) {});
    builder_->set_corners(*shape);
    return ShapeOfBody<dim>(std::move(shape), spare);
  }

  /** Relative to corner 0. */
  template <int dim>
  Point<dim> Cells<dim>::mean_of_corners(const std::size_t body) const
  {
    Point<dim> centre;
    for (const auto &corner : corners[body])
      centre += (corner - corners[body][0]) / double(dim + 1);
    return centre;
  }

  template <int dim>
  double Cells<dim>::volume_of_simplex(const std::size_t body) const
  {
    Tensor<2, dim> edges;
    for (unsigned int i = 0; i < dim; ++i)
      edges[i] = corners[body][i + 1] - corners[body][0];
    return determinant(edges) / (dim == 2 ? 2. : 6.);
  }

  template <int dim>
  std::vector<double>
  Cells<dim>::at_corners(const std::size_t body,
                         const std::vector<double> &nodal) const
  {
    const auto &of_class = class_shape(body);
    const double *u = nodal.data() + first_node[body] * dim;
    std::vector<double> result(of_class.corners.size() * dim, 0.);
    for (std::size_t v = 0; v < of_class.corners.size(); ++v)
      for (unsigned int i = 0; i < of_class.n_nodes; ++i)
        for (unsigned int c = 0; c < dim; ++c)
          result[v * dim + c] +=
              of_class.corner_values[v * of_class.n_nodes + i] * u[i * dim + c];
    return result;
  }

  template struct Cells<2>;
  template struct Cells<3>;
} // namespace nsfd
