#include "gathered.h"

#include <cstring>
#include <map>
#include <stdexcept>
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
        put(values.size());
        for (const T &value : values)
          put(value);
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
        for (T &value : values)
          get(value);
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

    template <typename T>
    void append(const std::vector<T> &from, const std::size_t count,
                std::vector<T> &to)
    {
      to.insert(to.end(), from.begin(), from.begin() + count);
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
    std::vector<Bodies> bodies(packages.size());
    std::vector<InterfacePoints<dim>> points(packages.size());
    std::map<std::uint64_t, unsigned int> first_of_key;
    for (std::size_t r = 0; r < packages.size(); ++r) {
      Package package(packages[r]);
      std::size_t n;
      package.get(n);
      bodies[r].classes.resize(n);
      for (BodyClass &body : bodies[r].classes) {
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
      package.get(bodies[r].class_of);
      package.get(bodies[r].first_dof);
      package.get(bodies[r].first_slot);
      package.get(bodies[r].slot_point);
      package.get(bodies[r].slot_sign);
      package.get(n);
      bodies[r].extra_points.resize(n);
      for (auto &[slot, point] : bodies[r].extra_points) {
        package.get(slot);
        package.get(point);
      }
      package.get(points[r].n_points);
      package.get(points[r].n_owned);
      package.get(points[r].position);
      package.get(points[r].frames);
      package.get(points[r].weight);
      package.get(points[r].faces);

      // the points that this rank owns
      const auto offset = unsigned(points_.n_points);
      for (auto face : points[r].faces)
        if (face.first < points[r].n_owned) {
          face.first += offset;
          face.neighbor_rank = -1;
          face.bodies = {{-1, -1}};
          if (!first_of_key.emplace(face.key, face.first).second)
            throw std::logic_error("two faces have the same key");
          points_.face_of.resize(face.first + face.count,
                                 unsigned(points_.faces.size()));
          points_.faces.push_back(face);
        }
      const std::size_t owned = points[r].n_owned;
      append(points[r].position, owned * dim, points_.position);
      append(points[r].frames, owned * dim * dim, points_.frames);
      append(points[r].weight, owned, points_.weight);
      points_.n_points += owned;
      points_.n_owned = points_.n_points;
    }

    bodies_.first_dof = bodies_.first_slot = {0};
    std::size_t owned_before = 0;
    for (std::size_t r = 0; r < packages.size(); ++r) {
      // all points of the rank, one more for slots without a point
      std::vector<unsigned int> point(points[r].n_points + 1,
                                      unsigned(points_.n_points));
      for (std::size_t i = 0; i < points[r].n_owned; ++i)
        point[i] = unsigned(owned_before + i);
      owned_before += points[r].n_owned;
      for (const auto &face : points[r].faces)
        for (unsigned int k = 0; k < face.count; ++k)
          point[face.first + k] = first_of_key.at(face.key) + k;

      const auto first_class = unsigned(bodies_.classes.size()),
                 first_body = unsigned(bodies_.size());
      const std::size_t dof = bodies_.n_dofs(),
                        slot = bodies_.first_slot.back();
      for (BodyClass &body : bodies[r].classes)
        bodies_.classes.push_back(std::move(body));
      for (std::size_t b = 0; b < bodies[r].size(); ++b) {
        bodies_.class_of.push_back(first_class + bodies[r].class_of[b]);
        bodies_.classes[bodies_.class_of.back()].bodies.push_back(first_body +
                                                                  unsigned(b));
        bodies_.first_dof.push_back(dof + bodies[r].first_dof[b + 1]);
        bodies_.first_slot.push_back(slot + bodies[r].first_slot[b + 1]);
        for (std::size_t s = bodies[r].first_slot[b];
             s < bodies[r].first_slot[b + 1]; ++s) {
          const unsigned int p = point[bodies[r].slot_point[s]];
          bodies_.slot_point.push_back(p);
          bodies_.slot_sign.push_back(bodies[r].slot_sign[s]);
          if (p < points_.n_points)
            points_.faces[points_.face_of[p]]
                .bodies[bodies[r].slot_sign[s] > 0 ? 1 : 0] =
                int(first_body + b);
        }
      }
      for (const auto &[s, p] : bodies[r].extra_points)
        bodies_.extra_points.emplace_back(slot + s, point[p]);
      point.pop_back();
      points_of_.push_back(std::move(point));
    }
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
