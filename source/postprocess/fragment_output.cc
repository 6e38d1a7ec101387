#include "fragment_output.h"

#include "vtkhdf_series.h"

#include "core/cost.h"
#include "nsfd/core/archive.h"
#include "nsfd/scene/scene_input.h"

#include <fmt/format.h>

#include <algorithm>

namespace nsfd
{
  namespace
  {
    /** A vertex for each fragment, with the columns of fragments.csv. */
    template <int dim>
    VtuGrid fragment_grid(const double time,
                          const std::vector<FragmentRecord> &records)
    {
      const std::string per_depth = dim == 2 ? "/m" : "";
      VtuGrid grid;
      grid.time = time;
      grid.point_data = {{"fragment", 1, {}, "", VtuNumber::integer},
                         {"cells", 1, {}, "", VtuNumber::integer},
                         {"mass", 1, {}, "kg" + per_depth},
                         {"velocity", 3, {}, "m/s"},
                         {"spin", 3, {}, "rad/s"},
                         {"size", 1, {}, "m"},
                         {"kinetic_translation", 1, {}, "J" + per_depth},
                         {"kinetic_spin", 1, {}, "J" + per_depth},
                         {"kinetic", 1, {}, "J" + per_depth},
                         {"surface", 1, {}, dim == 2 ? "m" : "m^2"}};
      for (const FragmentRecord &one : records) {
        const auto point = std::int64_t(grid.points.size());
        grid.points.push_back(one.centre);
        grid.add_cell(VtuCell::vertex, {point});
        const std::array<std::vector<double>, 10> values = {
            {{double(one.number)},
             {double(one.cells)},
             {one.mass},
             {one.velocity.begin(), one.velocity.end()},
             {one.spin.begin(), one.spin.end()},
             {one.size(dim)},
             {one.kinetic_translation},
             {one.kinetic_spin},
             {one.kinetic},
             {one.surface}}};
        for (std::size_t k = 0; k < values.size(); ++k)
          grid.point_data[k].values.insert(grid.point_data[k].values.end(),
                                           values[k].begin(), values[k].end());
      }
      return grid;
    }
  } // namespace

  template <int dim>
  bool has_fragments(const SceneInput &input,
                     const Discretization<dim> &discretization,
                     const Fragments<dim> &fragments,
                     const Communicator &communicator)
  {
    if (fragments.count() > 1)
      return true;
    // cells to come may lie at faces of any block
    if (input.mesh_changes())
      return std::any_of(
          input.interfaces.begin(), input.interfaces.end(),
          [](const InterfaceInput &block) { return bool(block.law); });
    const auto &origins = discretization.origins();
    return communicator.any(std::any_of(
        origins.begin(), origins.end(), [&](const PointOrigin &origin) {
          return origin.kind == PointOrigin::Kind::interface &&
                 input.interfaces[origin.block].law;
        }));
  }

  template <int dim>
  FragmentOutput<dim>::FragmentOutput(const std::string &directory,
                                      FragmentMotion<dim> motion,
                                      const Communicator &communicator,
                                      const bool resumes, const bool vtkhdf)
      : path_(directory + "/fragments.csv"), motion_(std::move(motion)),
        communicator_(communicator)
  {
    if (communicator.is_root() && !resumes)
      file_ = std::make_unique<RowFile>(path_, header());
    if (vtkhdf)
      series_ = std::make_unique<VtkhdfSeries>(directory + "/fragments");
  }

  template <int dim>
  FragmentOutput<dim>::~FragmentOutput() = default;

  template <int dim>
  std::string FragmentOutput<dim>::header()
  {
    return std::string("step,time,fragment,cells,mass,") +
           (dim == 2
                ? "x,y,vx,vy,spin,inertia,"
                : "x,y,z,vx,vy,vz,spin_x,spin_y,spin_z,inertia_xx,inertia_yy,"
                  "inertia_zz,inertia_xy,inertia_xz,inertia_yz,") +
           "size,kinetic_translation,kinetic_spin,kinetic,surface";
  }

  template <int dim>
  std::string FragmentOutput<dim>::line(const unsigned int step,
                                        const double time,
                                        const FragmentRecord &record)
  {
    std::string text = fmt::format("{},{},{},{},{}", step, time, record.number,
                                   record.cells, record.mass);
    const auto add = [&text](const double value) {
      text += fmt::format(",{}", value);
    };
    for (const Vec3 *vector : {&record.centre, &record.velocity})
      for (unsigned int c = 0; c < dim; ++c)
        add((*vector)[c]);
    const Mat3 &J = record.inertia;
    if (dim == 2) {
      add(record.spin[2]);
      add(J[2][2]);
    } else {
      for (const double spin : record.spin)
        add(spin);
      for (const double entry :
           {J[0][0], J[1][1], J[2][2], J[0][1], J[0][2], J[1][2]})
        add(entry);
    }
    for (const double value :
         {record.size(dim), record.kinetic_translation, record.kinetic_spin,
          record.kinetic, record.surface})
      add(value);
    return text;
  }

  template <int dim>
  void FragmentOutput<dim>::measure(const State &state,
                                    const Fragments<dim> &fragments)
  {
    if (measured_at_ == state.step)
      return;
    const Charge charge(Cost::fragments);
    records_ = motion_.measure(state, fragments);
    measured_at_ = state.step;
  }

  template <int dim>
  void FragmentOutput<dim>::write(const State &state,
                                  const Fragments<dim> &fragments)
  {
    measure(state, fragments);
    if (!file_)
      return;
    std::string rows;
    for (const FragmentRecord &record : records_)
      rows += (rows.empty() ? "" : "\n") + line(state.step, state.time, record);
    file_->write(rows);
    if (series_)
      series_->add(fragment_grid<dim>(state.time, records_));
  }

  template <int dim>
  void FragmentOutput<dim>::mesh_changed(const State &start)
  {
    motion_.mesh_changed(start);
  }

  template <int dim>
  void FragmentOutput<dim>::serialize(Archive &archive)
  {
    std::uintmax_t n_bytes = file_ ? file_->n_bytes() : 0;
    archive.numbers("fragments_bytes", n_bytes);
    if (series_) {
      const Archive::Part part(archive, "fragments");
      series_->serialize(archive);
    }
    if (!archive.reads())
      return;
    std::string failure;
    if (communicator_.is_root())
      try {
        const std::string rows = read_rows(path_, n_bytes);
        if (rows.empty() || rows.back() != '\n')
          failure = "'" + path_ + "' is not what it was at the checkpoint";
        else
          file_ = std::make_unique<RowFile>(path_, n_bytes);
      } catch (const std::exception &error) {
        failure = error.what();
      }
    if (communicator_.any(!failure.empty()))
      throw BadCheckpoint(failure);
  }

  template bool has_fragments(const SceneInput &, const Discretization<2> &,
                              const Fragments<2> &, const Communicator &);
  template bool has_fragments(const SceneInput &, const Discretization<3> &,
                              const Fragments<3> &, const Communicator &);
  template class FragmentOutput<2>;
  template class FragmentOutput<3>;
} // namespace nsfd
