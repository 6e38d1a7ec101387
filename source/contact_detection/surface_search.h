#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

namespace nsfd
{
  class Communicator;

  /**
   * Surfaces of bodies without their positions. A vertex belongs to one body,
   * or to several that hang together there; facets of a body share their
   * vertices.
   */
  template <int dim>
  struct Surfaces {
    /**
     * A flat piece: 2 vertices in the plane, its outward normal being b - a
     * turned by -90 degrees; 3 or 4 in space, counter-clockwise seen from
     * outside, 4 of them convex and perhaps slightly warped.
     */
    struct Facet {
      std::array<unsigned int, 4> vertex{};
      unsigned int n_vertices = dim;
      unsigned int body = 0;
      unsigned int whole = 0; ///< bodies that hang together have the same
      bool touches = true;    ///< false: it only says where the next ones end
      std::uint64_t key = 0;  ///< unique; decides where geometry does not
      /// key of one of those that are one flat side, see set_flat_sides()
      std::uint64_t side = 0;
    };
    /// no facet has it; exact as a double, as keys are
    static constexpr std::uint64_t no_key = (std::uint64_t(1) << 53) - 1;

    /** A vertex of a facet that may touch facets of other bodies. */
    struct Point {
      unsigned int vertex = 0, facet = 0;
      /// of the side that it was over in the last step: which way it came in
      std::uint64_t last_side = no_key;
      bool was_below = false; ///< the facet there
    };
    struct Ball {
      unsigned int body = 0;
      double radius = 0.;
      std::uint64_t key = 0;
      unsigned int vertex = 0; ///< the centre
    };
    /**
     * In space: where two facets of a body meet. The way from vertex 0 to
     * vertex 1 has facet 0 on its left, seen from outside.
     */
    struct Edge {
      std::array<unsigned int, 2> vertex{}, facet{};
    };

    std::vector<Facet> facets;
    std::vector<Point> points;
    std::vector<Ball> balls;
    std::vector<Edge> edges; ///< see set_edges(); of all bodies or of none
    std::size_t n_vertices = 0;
    /// the way from a vertex to a facet leads through the body of both, and it
    /// touches no such facet, however near it is; null: there are none
    std::function<bool(unsigned int vertex, unsigned int facet)> is_behind;
  };

  /**
   * The edges at which exactly two facets of a body meet, each once. Those of
   * bodies that keep their shape only if they stick out, at positions x. In the
   * plane there are none.
   */
  template <int dim>
  void set_edges(Surfaces<dim> &surfaces, const double *x,
                 const std::function<bool(unsigned int)> &keeps_shape);

  /**
   * The flat shape of a facet. A warped quadrilateral has the normal of its two
   * diagonals, the mean one: it does not jump inside the facet, unlike that of
   * two triangles, and is the same for whichever vertex comes first.
   */
  template <int dim>
  struct Plane {
    std::array<double, dim> normal{}, centre{};
    double size = 0.; ///< length or square root of the area
  };

  /**
   * A place on a facet and what is near it. The normal leads away from the
   * body of the facet; lengths are those of the positions.
   */
  template <int dim>
  struct FacetPair {
    unsigned int index = 0; ///< of the point or of the ball
    unsigned int facet = 0;
    double gap = 0.;
    std::array<double, dim> normal{}, closest{};
    std::array<double, 4> weights{}; ///< of the vertices of the facet
    double inset = 0.; ///< a corner that overlaps by less is not seen
  };

  /** ball < other; the normal leads from the other ball to this one. */
  template <int dim>
  struct BallPair {
    unsigned int ball = 0, other = 0;
    double gap = 0.;
    std::array<double, dim> normal{}, closest{}; ///< closest: on the other
  };

  /**
   * Two edges that cross, `edge` of the earlier body. The normal leads from the
   * other edge to this one; places are parts of the way along the edges.
   */
  template <int dim>
  struct EdgePair {
    unsigned int edge = 0, other = 0;
    double gap = 0.;
    std::array<double, dim> normal{}, closest{}; ///< closest: on the other
    double place = 0., other_place = 0.;
    bool is_sure = false; ///< which way is out, not only after a turn
  };

  template <int dim>
  struct NearPairs {
    std::vector<FacetPair<dim>> points; ///< at most one per point
    std::vector<FacetPair<dim>> balls;  ///< one per place that a ball is near
    std::vector<BallPair<dim>> ball_balls;
    std::vector<EdgePair<dim>> edges; ///< by edge, then by the other one
  };

  /** Bodies that are still joined; asked for two different bodies only. */
  using AreJoined = std::function<bool(unsigned int, unsigned int)>;

  /** List i is entries first[i] to first[i + 1]. */
  struct IndexLists {
    std::vector<std::size_t> first;
    std::vector<unsigned int> entries;
  };

  /** What may be near what until something has moved by half the skin. */
  struct NearCandidates {
    std::vector<unsigned int> order; ///< points, those of a vertex in a row
    IndexLists facets_of_points;     ///< one list per place in `order`
    IndexLists facets_of_balls;
    IndexLists balls_of_balls; ///< later balls only
    IndexLists edges_of_edges; ///< of later bodies only
    /// in the plane: the facets that a facet meets at its two vertices
    std::vector<std::array<unsigned int, 2>> next_facets;
    static constexpr unsigned int no_facet = unsigned(-1);
  };

  /**
   * Finds which points and balls are near which facets and balls of other
   * bodies, and which edges cross. Candidates are searched in a tree of boxes
   * with a skin around them and kept while nothing has moved by more than half
   * the skin. Pairs depend on positions and keys only, not on the order of
   * facets or on earlier calls.
   */
  template <int dim>
  class SurfaceSearch
  {
  public:
    /**
     * Shares the work among ranks, each for the bodies that it owns; a body has
     * one owner. find() is collective then: surfaces and positions are the same
     * on all ranks, and so are its pairs, which are those of one rank alone.
     */
    void share(const Communicator &communicator,
               std::function<bool(unsigned int)> is_own);

    /**
     * To be called when the surfaces or the joined bodies are no longer those
     * of the last call of `find`.
     */
    void topology_changed() { searched_at_.clear(); }

    /**
     * x: dim coordinates per vertex. Gaps up to `reach` are of interest. The
     * pairs are those of points by vertex, those of balls by ball. Points leave
     * to a pair of edges what that describes better. Vertices
     * should be numbered by where they are: a million facets numbered at random
     * take 1.5 to 3.5 times as long.
     */
    void find(const Surfaces<dim> &surfaces, const double *x, double reach,
              const AreJoined &joined, NearPairs<dim> &pairs);

    /** How often candidates have been searched. */
    std::size_t n_searches() const { return n_searches_; }

  private:
    void gather_pairs(const Surfaces<dim> &surfaces,
                      NearPairs<dim> &pairs) const;
    bool candidates_hold(const Surfaces<dim> &surfaces, const double *x,
                         double reach) const;

    const Communicator *all_ = nullptr; ///< null: not shared
    std::function<bool(unsigned int)> is_own_;
    NearCandidates candidates_;
    std::vector<Plane<dim>> planes_;
    std::vector<double> searched_at_; ///< x of the last search
    std::array<std::size_t, 4> searched_sizes_{};
    double searched_reach_ = 0., skin_ = 0.;
    std::size_t n_searches_ = 0;
  };
} // namespace nsfd
