#include "spread_bisection.h"

#include "checkpoint/checkpoint_archive.h"
#include "checkpoint/checkpoint_file.h"
#include "core/gather.h"
#include "mesh/spread_simplices.h"
#include "nsfd/core/archive.h"
#include "time_integration/serialize_state.h"

#include <mpi.h>

#include <stdexcept>

namespace nsfd
{
  namespace
  {
    /** What a run carries along, in the order of all cells; nothing but on the
        first rank. */
    std::vector<char> packed(const CheckpointOrders<2> &orders,
                             Leapfrog<2> &leapfrog, State &state)
    {
      std::unique_ptr<Hdf5Image> image;
      if (orders.communicator().is_root())
        image = std::make_unique<Hdf5Image>(checkpoint_file::head_size);
      CheckpointWriter<2> writer(orders, image.get());
      serialize(state, writer);
      leapfrog.serialize(writer);
      return image ? image->bytes() : std::vector<char>();
    }

    void unpack(std::vector<char> &bytes, const CheckpointOrders<2> &orders,
                Leapfrog<2> &leapfrog, State &state)
    {
      std::unique_ptr<Hdf5Image> image;
      if (orders.communicator().is_root())
        image = std::make_unique<Hdf5Image>(bytes);
      CheckpointReader<2> reader(orders, image.get());
      serialize(state, reader);
      leapfrog.resume_from(state);
      leapfrog.serialize(reader);
      leapfrog.show(state);
    }

    std::vector<MeshView::Point>
    of_all_ranks(const Communicator &communicator,
                 const std::vector<MeshView::Point> &points)
    {
      constexpr unsigned int width = 4;
      std::vector<double> mine;
      for (const auto &point : points)
        mine.insert(mine.end(), {point.position[0], point.position[1],
                                 point.utilisation, point.zone});
      const auto all = gather_all(communicator, mine);
      std::vector<MeshView::Point> result(all.size() / width);
      for (std::size_t k = 0; k < result.size(); ++k) {
        result[k].position = {{all[width * k], all[width * k + 1], 0.}};
        result[k].utilisation = all[width * k + 2];
        result[k].zone = all[width * k + 3];
      }
      return result;
    }
  } // namespace

  SpreadBisection::SpreadBisection(const SceneInput &input,
                                   const Communicator &communicator,
                                   Model<2> &model)
      : input_(input), communicator_(communicator), alone_(MPI_COMM_SELF),
        model_(model), fronts_(input, model)
  {
    whole_.warns = false; // the parts have
    const auto problems = whole_.build(input, alone_);
    if (!problems.empty())
      throw std::runtime_error(problems.front());
    mesh_ = std::make_unique<BisectedMesh>(input, alone_, whole_);
    model_.explicit_limit = whole_.explicit_limit;
    model_.control = model_.dynamic_control(input, 0.);
  }

  SpreadBisection::~SpreadBisection() = default;

  State SpreadBisection::start()
  {
    mesh_->start();
    build();
    return model_.initial_state();
  }

  State SpreadBisection::restore(const std::vector<std::uint32_t> &ids)
  {
    mesh_->restore(ids);
    build();
    return model_.initial_state();
  }

  void SpreadBisection::serialize(Archive &archive)
  {
    mesh_->serialize(archive);
  }

  /** The part of this rank, of the whole mesh. */
  void SpreadBisection::build()
  {
    // what is built from it looks at it no more after rebuild_joined()
    const auto before = std::move(model_.triangulation);
    model_.triangulation =
        spread_simplices<2>(mesh_->cells().mesh(), communicator_.mpi());
    std::vector<unsigned int> materials;
    for (const auto &cell : model_.triangulation->active_cell_iterators())
      materials.push_back(mesh_->material(cell->id().get_coarse_cell_id()));
    model_.groups->set_middles(
        middles_of(mesh_->cells(), *model_.triangulation));
    model_.rebuild_joined(input_, communicator_, materials);
    fronts_.mesh_changed();
  }

  /** On every rank. Collective. */
  State SpreadBisection::whole_of(State &state)
  {
    model_.leapfrog->show(state);
    auto bytes =
        packed(CheckpointOrders<2>(*model_.discretization, communicator_),
               *model_.leapfrog, state);
    auto n = static_cast<unsigned long long>(bytes.size());
    MPI_Bcast(&n, 1, MPI_UNSIGNED_LONG_LONG, 0, communicator_.mpi());
    bytes.resize(n);
    MPI_Bcast(bytes.data(), int(n), MPI_CHAR, 0, communicator_.mpi());
    whole_.renew_leapfrog(input_, alone_);
    State whole;
    unpack(bytes, CheckpointOrders<2>(*whole_.discretization, alone_),
           *whole_.leapfrog, whole);
    return whole;
  }

  void SpreadBisection::hand_out(State &whole, State &state)
  {
    auto bytes = packed(CheckpointOrders<2>(*whole_.discretization, alone_),
                        *whole_.leapfrog, whole);
    build();
    unpack(bytes, CheckpointOrders<2>(*model_.discretization, communicator_),
           *model_.leapfrog, state);
  }

  bool SpreadBisection::accept(State &state)
  {
    mesh_->count_step();
    if (!mesh_->is_due(state))
      return false;
    const auto fronts =
        of_all_ranks(communicator_, fronts_.new_ones(state.last_step));
    if (fronts.empty() || !mesh_->refine(fronts))
      return false;
    State whole = whole_of(state);
    mesh_->change(whole);
    hand_out(whole, state);
    return true;
  }

  void
  SpreadBisection::fill_counters(std::map<std::string, double> &counters) const
  {
    mesh_->fill_counters(counters);
  }
} // namespace nsfd
