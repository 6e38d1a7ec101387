#include "draft.h"

#include <fmt/format.h>

#include <algorithm>

// Where bodies are and what acts on them. The last direction is up.

namespace wall
{
  namespace
  {
    const std::vector<Substance> substances = {
        {"glass", 70e9, 0.22, 2500.},  {"steel", 210e9, 0.3, 7800.},
        {"PMMA", 3.24e9, 0.35, 1190.}, {"concrete", 30e9, 0.2, 2400.},
        {"rubber", 5e6, 0.45, 1100.},  {"ice", 9e9, 0.33, 917.},
        {"cork", 3e7, 0., 200.},       {"clay", 1e8, 0.4, 1900.}};

    /** Few digits, so that what is flush is written so. */
    double rounded(const double x, const double unit)
    {
      return std::round(x / unit * 1e7) / 1e7 * unit;
    }

    Body box(const Draft &draft, const std::string &name, const Vector &low,
             const Vector &size, const std::array<int, 3> &cells)
    {
      Body body;
      body.name = name;
      body.cells = cells;
      for (int d = 0; d < draft.dim; ++d) {
        body.low[d] = rounded(low[d], draft.unit);
        body.high[d] = rounded(low[d] + size[d], draft.unit);
      }
      return body;
    }

    /** About cells of one size. */
    std::array<int, 3> cells_of(const Vector &size, const double edge)
    {
      std::array<int, 3> cells{{1, 1, 1}};
      for (int d = 0; d < 3; ++d)
        cells[d] = std::max(1, int(std::lround(size[d] / edge)));
      return cells;
    }

    /** Sizes with the height in the last direction. */
    Vector sizes(const Draft &draft, const double width, const double height,
                 const double depth)
    {
      return draft.dim == 2 ? Vector{{width, height, 1.}}
                            : Vector{{width, depth, height}};
    }

    std::string top(const Draft &draft)
    {
      return draft.dim == 2 ? "top" : "front";
    }
    std::string bottom(const Draft &draft)
    {
      return draft.dim == 2 ? "bottom" : "back";
    }

    /** A body thrown at a plate. */
    void projectile(Draft &draft, Draw &draw)
    {
      const double u = draft.unit, w = u * draw.between(2., 5.),
                   t = u * draw.between(0.2, 0.8),
                   edge = t / draw.whole(1, draft.dim == 2 ? 4 : 2),
                   s = u * draw.between(0.4, 1.2);
      const Vector plate = sizes(draft, w, t, draft.dim == 2 ? 1. : w);
      Vector low{};
      for (int d = 0; d + 1 < draft.dim; ++d)
        low[d] = -0.5 * plate[d];
      draft.bodies.push_back(box(draft, "plate", low, plate,
                                 cells_of(plate, std::max(edge, w / 14))));
      const Vector size = sizes(draft, s, s * draw.between(0.5, 2.), s);
      for (int d = 0; d + 1 < draft.dim; ++d)
        low[d] = -0.5 * size[d] + u * draw.between(-0.3, 0.3);
      low[up(draft)] = t + draft.gap;
      draft.bodies.push_back(box(draft, "projectile", low, size,
                                 cells_of(size, s / draw.whole(1, 3))));
      Body &shot = draft.bodies.back();
      shot.velocity[up(draft)] = -draft.speed;
      if (draw.chance(0.3))
        shot.velocity[0] = draft.speed * draw.between(-1., 1.);
      if (draft.large && draw.chance(0.3)) {
        shot.shape = "ball";
        shot.cells = {{1, 1, 1}};
        shot.high[up(draft)] = shot.low[up(draft)] + shot.high[0] - shot.low[0];
      }
      if (draw.chance(0.6)) {
        hold(draft, "left", draw.chance(0.5));
        hold(draft, "right", draw.chance(0.5));
      }
    }

    /** Blocks on each other, pressed or dragged. */
    void stack(Draft &draft, Draw &draw)
    {
      const double u = draft.unit;
      const int n = draw.whole(2, 4);
      double height = 0.;
      for (int i = 0; i < n; ++i) {
        const double w =
            u * (i == 0 ? draw.between(1., 3.) : draw.between(0.5, 1.5));
        const Vector size = sizes(draft, w, u * draw.between(0.3, 1.), w);
        Vector low{};
        low[0] = draw.between(-0.2, 0.2) * u;
        low[up(draft)] = height;
        draft.bodies.push_back(box(
            draft, fmt::format("block{}", i + 1), low, size,
            cells_of(size, u / draw.between(1., draft.dim == 2 ? 5. : 2.))));
        height = draft.bodies.back().high[up(draft)];
      }
      draft.gravity = draw.chance(0.5) ? 9.81 : 0.;
      if (draw.chance(0.5))
        hold(draft, bottom(draft), true);
      else
        add_floor(draft, draw, 0.);
      if (draw.chance(0.7))
        drive(draft, draw, top(draft), draw.chance(0.5) ? up(draft) : 0, -1.);
      else {
        draft.gap = 0.;
        draft.bodies.back().velocity[0] = draft.speed;
      }
    }

    /** A row of bodies, of which the first moves. */
    void row(Draft &draft, Draw &draw)
    {
      const double u = draft.unit;
      const int n = draw.whole(2, 6), cells = draw.whole(1, 3);
      const bool balls = draft.large && draw.chance(0.3);
      double place = 0.;
      for (int i = 0; i < n; ++i) {
        const Vector size = sizes(draft, u * draw.between(0.5, 1.),
                                  u * draw.between(0.5, 1.), u);
        Vector low{};
        low[0] = place;
        low[up(draft)] = draw.between(-0.1, 0.1) * u;
        draft.bodies.push_back(box(draft, fmt::format("bar{}", i + 1), low,
                                   size, cells_of(size, u / cells)));
        if (balls) {
          Body &ball = draft.bodies.back();
          ball.shape = "ball";
          for (int d = 0; d < draft.dim; ++d) {
            ball.low[d] = d == 0 ? place : -0.5 * u;
            ball.high[d] = ball.low[d] + u;
          }
        }
        place = draft.bodies.back().high[0] + (i == 0 ? draft.gap : 0.);
      }
      draft.bodies[0].velocity[0] = draft.speed;
      if (draw.chance(0.3))
        hold(draft, "right", draw.chance(0.5));
    }

    /** Many bodies in any position that fall together. */
    void heap(Draft &draft, Draw &draw)
    {
      const double u = draft.unit;
      const int n = draw.whole(3, draft.dim == 2 ? 20 : 8),
                across = std::max(2, int(std::sqrt(double(n))));
      double x = 0., height = 0., next = 0.;
      for (int i = 0; i < n; ++i) {
        if (i % across == 0) {
          x = draw.between(0., 0.5) * u;
          height = next + draft.gap;
        }
        const Vector size =
            sizes(draft, u * draw.between(0.5, 1.), u * draw.between(0.3, 0.7),
                  u * draw.between(0.5, 1.));
        const double angle = draw.chance(0.7) ? draw.between(-0.4, 0.4) : 0.,
                     c = std::cos(angle), s = std::abs(std::sin(angle)),
                     w = size[0], h = size[up(draft)],
                     // numbers are rounded, and corners shall not overlap
            hair = angle != 0. ? 1e-6 * u : 0.;
        // turned about its centre it needs more place
        Vector low{};
        low[0] = x + 0.5 * (w * c + h * s - w) + hair;
        low[up(draft)] = height + 0.5 * (h * c + w * s - h) + hair;
        const bool single = draft.kind == Kind::rigid || draft.dim == 3;
        draft.bodies.push_back(
            box(draft, fmt::format("stone{}", i + 1), low, size,
                cells_of(size, u / draw.whole(1, single ? 1 : 3))));
        Body &stone = draft.bodies.back();
        stone.angle = angle;
        stone.velocity[up(draft)] = -draft.speed;
        stone.velocity[0] = draft.speed * draw.between(-0.5, 0.5);
        x += w * c + h * s + 2. * hair + draft.gap;
        next = std::max(next, height + h * c + w * s + 2. * hair);
      }
      draft.gravity = draw.chance(0.5) ? 9.81 : 0.;
      if (draw.chance(0.8))
        add_floor(draft, draw, 0.);
    }

    /** One body, driven or thrown. */
    void alone(Draft &draft, Draw &draw)
    {
      const double u = draft.unit;
      const Vector size =
          sizes(draft, u * draw.between(1., 3.), u * draw.between(0.5, 1.5), u);
      Vector low{};
      low[up(draft)] = draft.gap;
      draft.bodies.push_back(
          box(draft, "block", low, size,
              cells_of(size, u / draw.whole(1, draft.dim == 2 ? 5 : 2))));
      Body &block = draft.bodies[0];
      if (draft.touches && draft.large && draw.chance(0.3)) {
        Vector above = block.centre();
        above[up(draft)] = block.high[up(draft)] + draft.gap + 0.5 * u;
        add_hammer(draft, draw, above, 0.5 * u);
        if (draw.chance(0.6))
          hold(draft, bottom(draft), draw.chance(0.5));
        return;
      }
      if (draft.touches) {
        block.velocity[up(draft)] = -draft.speed;
        if (draw.chance(0.4))
          block.velocity[0] = draft.speed * draw.between(-1., 1.);
        add_floor(draft, draw, 0.);
        return;
      }
      const double fate = draw.between(0., 1.);
      if (fate < 0.25) { // it flies freely
        block.velocity[0] = draft.speed;
        block.angle = draft.large ? draw.between(-1., 1.) : 0.;
        return;
      }
      // nothing else holds a body at rest
      hold(draft, "left",
           draw.chance(0.6) || draft.integrator == "quasi-static");
      drive(draft, draw, "right", draw.chance(0.7) ? 0 : up(draft),
            draw.chance(0.7) ? 1. : -1.);
    }

    /** A plate with a slot from the left, pulled open. */
    void notched(Draft &draft, Draw &draw)
    {
      const double u = draft.unit;
      const Vector size = {{u * draw.between(1., 3.), u, 1.}};
      Body plate = box(draft, "plate", {}, size,
                       cells_of(size, u / (2 * draw.whole(1, 4))));
      plate.cells[1] += 1 - plate.cells[1] % 2; // the slot is a row of cells
      plate.shape = "notched";
      draft.bodies.push_back(plate);
      drive(draft, draw, "top", 1, 1.);
      if (draw.chance(0.5))
        hold(draft, "bottom", draw.chance(0.5));
      else
        drive(draft, draw, "bottom", 1, -1.);
    }

    /** Parts with one mesh whose sides meet node by node. */
    void parts(Draft &draft, Draw &draw)
    {
      const double u = draft.unit;
      const int n = draw.whole(2, 4),
                cells = draw.whole(1, draft.dim == 2 ? 4 : 2);
      draft.jointed = draw.chance(0.3);
      const Vector size = sizes(draft, u * draw.between(0.5, 2.), u, u);
      for (int i = 0; i < n; ++i) {
        Vector low{};
        low[0] = i == 0 ? 0. : draft.bodies.back().high[0];
        draft.bodies.push_back(box(draft, fmt::format("part{}", i + 1), low,
                                   size, cells_of(size, u / cells)));
        // the row as it is: sides must be written the same
        draft.bodies.back().low[0] = low[0];
        draft.bodies.back().velocity[0] =
            draft.speed * (i == 0 ? 1. : draw.between(-0.2, 0.2));
        if (draw.chance(0.2))
          draft.bodies.back().velocity[up(draft)] =
              draft.speed * draw.between(-1., 1.);
      }
      if (draw.chance(0.3))
        hold(draft, "right", draw.chance(0.5));
      if (draw.chance(0.3)) {
        for (Body &body : draft.bodies)
          body.velocity = {};
        drive(draft, draw, "left", 0, 1.);
      }
    }

    void give_substances(Draft &draft, Draw &draw)
    {
      const bool several = draw.chance(0.25),
                 // all bodies of a mesh have cells of one sort
          simplices = (draft.large || !draft.touches) && draw.chance(0.25),
                 gmsh = simplices && draw.chance(0.4);
      const char *const triangles =
          draw.chance(0.6) ? "crossed triangles" : "diagonal triangles";
      for (std::size_t i = 0; i < draft.bodies.size(); ++i) {
        Body &body = draft.bodies[i];
        body.substance =
            several ? substances[draw.whole(0, 7)] : draft.substance;
        const std::size_t role = draw.one_of({0.4, 0.3, 0.3});
        body.rigid = draft.kind == Kind::rigid ||
                     (draft.kind == Kind::mixed && role == 0 && i > 0);
        body.breakable =
            !body.rigid && (draft.kind == Kind::breakable ||
                            (draft.kind == Kind::mixed && role == 1));
        if (body.shape == "notched")
          continue;
        if (simplices)
          body.shape = gmsh             ? "gmsh"
                       : draft.dim == 2 ? triangles
                                        : "tetrahedra";
        else if (draw.chance(0.15) && draft.large)
          body.distortion = draw.between(0.05, 0.2);
      }
    }

    /** Points of all faces, some: two to four of a face, and half of the faces
     * of a cell are its own. */
    int n_points(const Draft &draft)
    {
      int n = 0;
      for (const Body &body : draft.bodies)
        if (!body.rigid) {
          const bool boxes = body.is_boxes() || body.shape == "ball";
          n += body.n_cells(draft.dim) *
               (draft.dim == 2 ? (boxes ? 4 : 3) : (boxes ? 12 : 6));
        }
      return n;
    }

    /** What may all break is what ten seconds of CPU hold: tetrahedra, and all
     * cells that implicit steps of large motions move. */
    void coarsen(Draft &draft)
    {
      const bool iterates = draft.iterates_on_cracks();
      constexpr int most_points = 250, most_tetrahedra = 300;
      const auto counts = [&](const Body &body) {
        return body.shape != "ball" &&
               (iterates ? !body.rigid : body.breakable && !body.is_boxes());
      };
      const auto is_heavy = [&] {
        if (iterates)
          return n_points(draft) > most_points;
        int n = 0;
        for (const Body &body : draft.bodies)
          if (counts(body))
            n += body.n_cells(draft.dim);
        return draft.dim == 3 && draft.large && n > most_tetrahedra;
      };
      while (is_heavy()) {
        int *largest = nullptr;
        for (Body &body : draft.bodies)
          if (counts(body))
            for (int &n : body.cells)
              if (!largest || n > *largest)
                largest = &n;
        if (!largest || *largest == 1)
          return;
        --*largest;
      }
    }

    void draw_bodies(Draft &draft, Draw &draw)
    {
      if (!draft.touches && draft.dim == 2 && draw.chance(0.3))
        notched(draft, draw);
      else if (!draft.touches)
        alone(draft, draw);
      else if (!draft.large) {
        if (draw.chance(0.3))
          alone(draft, draw);
        else
          parts(draft, draw);
      } else {
        const std::size_t which = draw.one_of({0.3, 0.2, 0.2, 0.2, 0.1});
        (which == 0   ? projectile
         : which == 1 ? stack
         : which == 2 ? row
         : which == 3 ? heap
                      : alone)(draft, draw);
      }
      give_substances(draft, draw);
    }
  } // namespace

  int Body::n_cells(const int dim) const
  {
    if (shape == "ball")
      return dim == 2 ? 5 : 7;
    return cells[0] * cells[1] * (dim == 3 ? cells[2] : 1) *
           (is_boxes() ? 1
            : dim == 2 ? 4
                       : 24);
  }

  double Body::edge(const int dim) const
  {
    if (shape == "ball")
      return 0.3 * (high[0] - low[0]);
    double edge = 1e30;
    for (int d = 0; d < dim; ++d)
      edge = std::min(edge, (high[d] - low[d]) / cells[d]);
    return is_boxes() ? edge : 0.5 * edge;
  }

  double Draft::wave_speed() const
  {
    double c = 0.;
    for (const Body &body : bodies)
      c = std::max(c, body.substance.wave_speed());
    return c;
  }

  double Draft::smallest_edge() const
  {
    double edge = 1e30;
    for (const Body &body : bodies)
      edge = std::min(edge, body.edge(dim));
    return edge;
  }

  double Draft::mesh_size() const
  {
    double size = 2. * smallest_edge();
    if (iterates_on_cracks()) // a plate is not as fine all over as it is thin
      for (const Body &body : bodies)
        for (int d = 0; d < dim; ++d)
          size = std::max(size, (body.high[d] - body.low[d]) / body.cells[d]);
    return size;
  }

  void Draft::end_at_half(const double speed, const int d, const double start,
                          const double away)
  {
    double size = 1e30;
    for (const Body &body : bodies)
      size = std::min(size, body.high[d] - body.low[d]);
    longest = std::min(longest, start + (away + 0.5 * size) / speed);
  }

  bool Draft::is_rigid() const
  {
    return std::all_of(bodies.begin(), bodies.end(),
                       [](const Body &body) { return body.rigid; });
  }

  bool Draft::iterates_on_cracks() const
  {
    return large && integrator == "moreau-jean" &&
           std::any_of(bodies.begin(), bodies.end(),
                       [](const Body &body) { return body.breakable; });
  }

  int Draft::n_cells() const
  {
    int n = 0;
    for (const Body &body : bodies)
      n += body.n_cells(dim);
    return n;
  }

  void lay_out(Draft &draft, Draw &draw)
  {
    draft.unit = draw.decades(1e-3, 1.);
    // three digits
    const double power = std::pow(10., std::floor(std::log10(draft.unit)) - 1.);
    draft.unit = std::round(draft.unit / power) * power;
    draft.substance = substances[draw.whole(0, 7)];
    const double slowness = draw.decades(1e-4, 0.3);
    draft.speed = slowness * draft.substance.wave_speed();
    // closed about when a wave has crossed a body
    draft.gap =
        draw.chance(0.25)
            ? 0.
            : draft.unit * std::min(0.3, slowness * draw.decades(0.1, 2.));
    // what they are made of comes last, and speeds depend on it
    draft.slowest = draft.substance;
    Draft trial = draft;
    Draw again = draw;
    draw_bodies(trial, again);
    for (const Body &body : trial.bodies)
      if (body.substance.wave_speed() < draft.slowest.wave_speed())
        draft.slowest = body.substance;
    draft.speed = slowness * draft.slowest.wave_speed();
    draw_bodies(draft, draw);
    coarsen(draft);
  }
} // namespace wall
