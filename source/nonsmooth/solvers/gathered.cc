#include "gathered.h"

#include <algorithm>
#include <cstring>
#include <stdexcept>
#include <tuple>
#include <type_traits>

namespace nsfd
{
  namespace
  {
    /** Plain values one after the other, and back in the same order. */
    class Package
    {
    public:
      Package() = default;
      explicit Package(const std::vector<char> &bytes) : bytes_(bytes) {}
      const std::vector<char> &bytes() const { return bytes_; }

      template <typename T>
      void put(const T &value)
      {
        static_assert(std::is_trivially_copyable_v<T>);
        const char *first = reinterpret_cast<const char *>(&value);
        bytes_.insert(bytes_.end(), first, first + sizeof(T));
      }
      template <typename T>
      void put(const std::vector<T> &values)
      {
        static_assert(std::is_trivially_copyable_v<T>);
        put(values.size());
        const char *first = reinterpret_cast<const char *>(values.data());
        bytes_.insert(bytes_.end(), first, first + values.size() * sizeof(T));
      }
      void put(const Block &block)
      {
        put(block.rows);
        put(block.cols);
        put(block.values);
      }
      template <typename T>
      void get(T &value)
      {
        static_assert(std::is_trivially_copyable_v<T>);
        std::memcpy(&value, &bytes_.at(next_), sizeof(T));
        next_ += sizeof(T);
      }
      template <typename T>
      void get(std::vector<T> &values)
      {
        std::size_t size;
        get(size);
        values.resize(size);
        const char *first = bytes_.data() + next_;
        next_ += size * sizeof(T);
        if (next_ > bytes_.size())
          throw std::out_of_range("Package: it ends early");
        std::copy_n(first, size * sizeof(T),
                    reinterpret_cast<char *>(values.data()));
      }
      void get(Block &block)
      {
        get(block.rows);
        get(block.cols);
        get(block.values);
      }

    private:
      std::vector<char> bytes_;
      std::size_t next_ = 0;
    };

    template <int dim>
    std::vector<char> pack(const Bodies &bodies,
                           const InterfacePoints<dim> &points)
    {
      Package package;
      package.put(bodies.classes.size());
      for (const BodyClass &body : bodies.classes) {
        package.put(body.n_dofs);
        package.put(body.n_slots);
        package.put(body.rigid);
        package.put(body.material);
        package.put(body.mass);
        package.put(body.stiffness);
        package.put(body.damping);
        package.put(body.trace);
        package.put(body.rigid_motions);
      }
      package.put(bodies.class_of);
      package.put(bodies.first_dof);
      package.put(bodies.first_slot);
      package.put(bodies.slot_point);
      package.put(bodies.slot_sign);
      package.put(bodies.extra_points.size());
      for (const auto &[slot, point] : bodies.extra_points) {
        package.put(slot);
        package.put(point);
      }
      package.put(points.n_points);
      package.put(points.n_owned);
      package.put(points.position);
      package.put(points.frames_of_points());
      package.put(points.weight);
      package.put(points.faces);
      return package.bytes();
    }

    template <int dim>
    Part<dim> unpack(const std::vector<char> &bytes)
    {
      Part<dim> part;
      auto &[bodies, points] = part;
      Package package(bytes);
      std::size_t n;
      package.get(n);
      bodies.classes.resize(n);
      for (BodyClass &body : bodies.classes) {
        package.get(body.n_dofs);
        package.get(body.n_slots);
        package.get(body.rigid);
        package.get(body.material);
        package.get(body.mass);
        package.get(body.stiffness);
        package.get(body.damping);
        package.get(body.trace);
        package.get(body.rigid_motions);
      }
      package.get(bodies.class_of);
      package.get(bodies.first_dof);
      package.get(bodies.first_slot);
      package.get(bodies.slot_point);
      package.get(bodies.slot_sign);
      package.get(n);
      bodies.extra_points.resize(n);
      for (auto &[slot, point] : bodies.extra_points) {
        package.get(slot);
        package.get(point);
      }
      package.get(points.n_points);
      package.get(points.n_owned);
      package.get(points.position);
      package.get(points.frames);
      package.get(points.weight);
      package.get(points.faces);
      return part;
    }

    /** @p count values of @p from, the first of which is at @p first. */
    template <typename T>
    void append(const std::vector<T> &from, const std::size_t first,
                const std::size_t count, std::vector<T> &to)
    {
      const auto begin = from.begin() + long(first);
      to.insert(to.end(), begin, begin + long(count));
    }

    /** Byte counts of all ranks, on the first one, and where they begin. */
    struct Counts {
      std::vector<int> count, first;
      Counts(const Communicator &communicator, const std::size_t mine)
          : count(communicator.size()), first(communicator.size() + 1, 0)
      {
        const int n = int(mine);
        MPI_Gather(&n, 1, MPI_INT, count.data(), 1, MPI_INT, 0,
                   communicator.mpi());
        for (std::size_t r = 0; r < count.size(); ++r)
          first[r + 1] = first[r] + count[r];
      }
    };
  } // namespace

  template <int dim>
  Gathered<dim>::Gathered(const DelassusOperator<dim> &delassus)
      : communicator_(delassus.communicator()),
        n_points_(delassus.points().n_points),
        n_owned_(delassus.points().n_owned), terms_(delassus.terms()),
        alone_(MPI_COMM_SELF)
  {
    const auto mine = pack<dim>(delassus.bodies(), delassus.points());
    const Counts bytes(communicator_, mine.size());
    std::vector<char> all(std::size_t(bytes.first.back()));
    MPI_Gatherv(mine.data(), int(mine.size()), MPI_CHAR, all.data(),
                bytes.count.data(), bytes.first.data(), MPI_CHAR, 0,
                communicator_.mpi());
    if (!communicator_.is_root())
      return;
    std::vector<std::vector<char>> packages;
    for (int r = 0; r < communicator_.size(); ++r)
      packages.emplace_back(all.begin() + bytes.first[r],
                            all.begin() + bytes.first[r + 1]);
    build(packages);
    delassus_ = make_local_delassus<dim>(alone_, bodies_, points_);
    delassus_->set_terms(terms_);
  }

  template <int dim>
  void Gathered<dim>::build(const std::vector<std::vector<char>> &packages)
  {
    std::vector<Part<dim>> parts;
    for (const auto &bytes : packages)
      parts.push_back(unpack<dim>(bytes));
    add_points(parts);
    add_bodies(parts);
  }

  /** The points that the ranks own, face by face in the order of their keys. */
  template <int dim>
  void Gathered<dim>::add_points(const std::vector<Part<dim>> &parts)
  {
    struct Owned {
      std::uint64_t key;
      const InterfacePoints<dim> *points;
      std::size_t face;
      std::size_t first; ///< of its points among those of all, rank by rank
    };
    std::vector<Owned> faces;
    std::size_t n = 0;
    for (const auto &part : parts) {
      for (std::size_t f = 0; f < part.points.faces.size(); ++f) {
        const auto &face = part.points.faces[f];
        if (face.first < part.points.n_owned)
          faces.push_back({face.key, &part.points, f, n + face.first});
      }
      n += part.points.n_owned;
    }
    std::sort(faces.begin(), faces.end(),
              [](const Owned &a, const Owned &b) { return a.key < b.key; });
    place_.resize(n);
    points_.n_points = points_.n_owned = n;
    for (const Owned &owned : faces) {
      auto face = owned.points->faces[owned.face];
      const std::size_t from = face.first;
      face.first = unsigned(points_.face_of.size());
      face.neighbor_rank = -1;
      face.bodies = {{-1, -1}};
      if (!points_.faces.empty() && points_.faces.back().key == face.key)
        throw std::logic_error("two faces have the same key");
      for (unsigned int k = 0; k < face.count; ++k)
        place_[owned.first + k] = face.first + k;
      points_.face_of.insert(points_.face_of.end(), face.count,
                             unsigned(points_.faces.size()));
      points_.faces.push_back(face);
      append(owned.points->position, from * dim, face.count * dim,
             points_.position);
      append(owned.points->frames, from * dim * dim, face.count * dim * dim,
             points_.frames);
      append(owned.points->weight, from, face.count, points_.weight);
    }
  }

  /** The bodies of the ranks, in the order of the faces that they have. */
  template <int dim>
  void Gathered<dim>::add_bodies(std::vector<Part<dim>> &parts)
  {
    const auto face_of_key = [this](const std::uint64_t key) {
      return std::lower_bound(
          points_.faces.begin(), points_.faces.end(), key,
          [](const auto &face, const std::uint64_t k) { return face.key < k; });
    };
    struct Body {
      unsigned int first; ///< of the points at its slots
      signed char sign;
      std::size_t part, body;
    };
    std::vector<Body> order;
    std::vector<unsigned int> first_class;
    const unsigned int nowhere = unsigned(points_.n_points);
    for (std::size_t r = 0; r < parts.size(); ++r) {
      Bodies &bodies = parts[r].bodies;
      // all points of the rank, one more for slots without a point
      std::vector<unsigned int> point(parts[r].points.n_points + 1, nowhere);
      for (const auto &face : parts[r].points.faces)
        for (unsigned int k = 0; k < face.count; ++k)
          point[face.first + k] = face_of_key(face.key)->first + k;
      for (unsigned int &p : bodies.slot_point)
        p = point[p];
      for (auto &extra : bodies.extra_points)
        extra.second = point[extra.second];
      for (std::size_t b = 0; b < bodies.size(); ++b) {
        Body body{nowhere, 0, r, b};
        for (std::size_t s = bodies.first_slot[b]; s < bodies.first_slot[b + 1];
             ++s)
          if (bodies.slot_point[s] < body.first) {
            body.first = bodies.slot_point[s];
            body.sign = bodies.slot_sign[s];
          }
        order.push_back(body);
      }
      point.pop_back();
      points_of_.push_back(std::move(point));
      first_class.push_back(unsigned(bodies_.classes.size()));
      for (BodyClass &body : bodies.classes)
        bodies_.classes.push_back(std::move(body));
    }
    std::stable_sort(
        order.begin(), order.end(), [](const Body &a, const Body &b) {
          return std::tie(a.first, a.sign) < std::tie(b.first, b.sign);
        });

    bodies_.first_dof = bodies_.first_slot = {0};
    std::vector<std::vector<std::size_t>> slot_of(parts.size());
    for (std::size_t r = 0; r < parts.size(); ++r)
      slot_of[r].resize(parts[r].bodies.slot_point.size());
    for (const auto &[first, sign, r, b] : order) {
      const Bodies &bodies = parts[r].bodies;
      const auto number = unsigned(bodies_.size());
      bodies_.class_of.push_back(first_class[r] + bodies.class_of[b]);
      bodies_.classes[bodies_.class_of.back()].bodies.push_back(number);
      bodies_.first_dof.push_back(bodies_.first_dof.back() +
                                  bodies.first_dof[b + 1] -
                                  bodies.first_dof[b]);
      for (std::size_t s = bodies.first_slot[b]; s < bodies.first_slot[b + 1];
           ++s) {
        slot_of[r][s] = bodies_.slot_point.size();
        const unsigned int p = bodies.slot_point[s];
        bodies_.slot_point.push_back(p);
        bodies_.slot_sign.push_back(bodies.slot_sign[s]);
        if (p < nowhere)
          points_.faces[points_.face_of[p]]
              .bodies[bodies.slot_sign[s] > 0 ? 1 : 0] = int(number);
      }
      bodies_.first_slot.push_back(bodies_.slot_point.size());
    }
    for (std::size_t r = 0; r < parts.size(); ++r)
      for (const auto &[slot, point] : parts[r].bodies.extra_points)
        bodies_.extra_points.emplace_back(slot_of[r][slot], point);
    std::sort(bodies_.extra_points.begin(), bodies_.extra_points.end());
  }

  template <int dim>
  template <typename T>
  void Gathered<dim>::collect(const std::vector<T> &mine,
                              const std::size_t stride,
                              std::vector<T> &all) const
  {
    if (!communicator_.any(!mine.empty())) {
      all.clear();
      return;
    }
    std::vector<T> owned(mine);
    owned.resize(n_owned_ * stride);
    const Counts bytes(communicator_, owned.size() * sizeof(T));
    all.resize(std::size_t(bytes.first.back()) / sizeof(T));
    MPI_Gatherv(owned.data(), int(owned.size() * sizeof(T)), MPI_CHAR,
                all.data(), bytes.count.data(), bytes.first.data(), MPI_CHAR, 0,
                communicator_.mpi());
    if (!communicator_.is_root())
      return;
    const std::vector<T> by_rank(all);
    for (std::size_t i = 0; i < place_.size(); ++i)
      std::copy_n(by_rank.begin() + long(i * stride), stride,
                  all.begin() + long(place_[i] * stride));
  }

  template <int dim>
  OneStepProblem<dim>
  Gathered<dim>::gather(const OneStepProblem<dim> &problem) const
  {
    OneStepProblem<dim> all;
    all.n_points = all.n_owned = points_.n_points;
    all.time_step = problem.time_step;
    all.theta = problem.theta;
    all.rule = problem.rule;
    all.interactions = problem.interactions;
    collect(problem.kind, 1, all.kind);
    collect(problem.mask, 1, all.mask);
    collect(problem.contact, 1, all.contact);
    collect(problem.interaction, 1, all.interaction);
    std::vector<std::uint8_t> acts(problem.n_points, 0), all_act;
    for (const unsigned int i : problem.acting)
      acts[i] = 1;
    collect(acts, 1, all_act);
    for (std::size_t i = 0; i < all_act.size(); ++i)
      if (all_act[i])
        all.acting.push_back(unsigned(i));
    for (const auto member :
         {&OneStepProblem<dim>::weight, &OneStepProblem<dim>::strength_factor,
          &OneStepProblem<dim>::opening_factor,
          &OneStepProblem<dim>::friction_factor,
          &OneStepProblem<dim>::opening_max, &OneStepProblem<dim>::slip_max,
          &OneStepProblem<dim>::compression_stiffness,
          &OneStepProblem<dim>::viscosity, &OneStepProblem<dim>::dilatancy,
          &OneStepProblem<dim>::lift_left, &OneStepProblem<dim>::target,
          &OneStepProblem<dim>::majorant_normal,
          &OneStepProblem<dim>::majorant_tangential})
      collect(problem.*member, 1, all.*member);
    for (const auto member :
         {&OneStepProblem<dim>::free_velocity,
          &OneStepProblem<dim>::given_velocity, &OneStepProblem<dim>::jump_old,
          &OneStepProblem<dim>::jump_free,
          &OneStepProblem<dim>::sliding_offset})
      collect(problem.*member, dim, all.*member);
    return all;
  }

  template <int dim>
  std::vector<double>
  Gathered<dim>::gather(const std::vector<double> &impulse) const
  {
    std::vector<double> all;
    collect(impulse, dim, all);
    return all;
  }

  template <int dim>
  void Gathered<dim>::scatter(const std::vector<double> &all,
                              std::vector<double> &impulse) const
  {
    const Counts values(communicator_, n_points_ * dim);
    std::vector<double> sent;
    for (const auto &points : points_of_)
      for (const unsigned int point : points)
        sent.insert(sent.end(), all.begin() + std::size_t(point) * dim,
                    all.begin() + std::size_t(point + 1) * dim);
    impulse.resize(n_points_ * dim);
    MPI_Scatterv(sent.data(), values.count.data(), values.first.data(),
                 MPI_DOUBLE, impulse.data(), int(impulse.size()), MPI_DOUBLE, 0,
                 communicator_.mpi());
  }

  template class Gathered<2>;
  template class Gathered<3>;
} // namespace nsfd
