#include "observers.h"

#include "run_view.h"

#include "nsfd/core/archive.h"
#include "nsfd/scene/scene_input.h"
#include "table_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <limits>
#include <stdexcept>

namespace nsfd
{
  template <int dim>
  Observers<dim>::Observers(const SceneInput &input,
                            const Discretization<dim> &discretization,
                            const Communicator &communicator)
      : input_(input), communicator_(communicator),
        view_(std::make_unique<RunViewOf<dim>>(input, discretization,
                                               communicator)),
        files_(input.observables.size())
  {
    for (const ObservableInput &block : input.observables) {
      auto &record = records_.emplace_back();
      record.name = block.name;
      record.type = block.type;
    }
  }

  template <int dim>
  Observers<dim>::~Observers() = default;

  template <int dim>
  void Observers<dim>::find(const dealii::Triangulation<dim> &triangulation,
                            const MeshGroups<dim> &groups)
  {
    view_->find(triangulation, groups);
    for (std::size_t k = 0; k < records_.size(); ++k) {
      Observable &observable = *input_.observables[k].observable;
      try {
        observable.find(*view_);
      } catch (const std::runtime_error &error) {
        throw std::runtime_error("Observable: " + records_[k].name + ": " +
                                 error.what());
      }
      records_[k].columns = observable.columns();
    }
  }

  template <int dim>
  std::string Observers<dim>::path(const std::size_t k,
                                   const char *ending) const
  {
    return input_.output.directory + "/observables/" + records_[k].name +
           ending + ".csv";
  }

  template <int dim>
  std::vector<std::string> Observers<dim>::titles(const std::size_t k,
                                                  const bool of_profile) const
  {
    std::vector<std::string> names = {"step", "time"};
    const auto columns =
        of_profile ? input_.observables[k].observable->profile_columns()
                   : records_[k].columns;
    if (columns.empty())
      return {};
    for (const ObservedColumn &column : columns)
      names.push_back(column.name);
    return names;
  }

  template <int dim>
  void Observers<dim>::start_files()
  {
    if (!communicator_.is_root())
      return;
    std::filesystem::create_directories(input_.output.directory +
                                        "/observables");
    for (std::size_t k = 0; k < records_.size(); ++k) {
      files_[k].rows =
          std::make_unique<TableFile>(path(k, ""), titles(k, false));
      const auto names = titles(k, true);
      if (!names.empty())
        files_[k].profile =
            std::make_unique<TableFile>(path(k, "_profile"), names);
    }
  }

  template <int dim>
  void Observers<dim>::observe(const State &state, const State *previous,
                               const HistoryRow &row)
  {
    view_->motion().show(state, previous, row);
    for (std::size_t k = 0; k < records_.size(); ++k) {
      const ObservableInput &block = input_.observables[k];
      block.observable->follow(*view_);
      if (row.step % block.every != 0)
        continue;
      const auto values = block.observable->values(*view_);
      records_[k].add(row.time, values, communicator_.is_root());
      if (!files_[k].rows)
        continue;
      std::vector<double> line = {double(row.step), row.time};
      line.insert(line.end(), values.begin(), values.end());
      files_[k].rows->write(line);
    }
    view_->motion().forget();
  }

  /** Sorted by their places: the same for any number of ranks. */
  template <int dim>
  void Observers<dim>::write_profiles(const State &state,
                                      const double time_step)
  {
    HistoryRow row;
    row.step = state.step;
    row.time = state.time;
    row.time_step = time_step;
    view_->motion().show(state, nullptr, row);
    for (std::size_t k = 0; k < records_.size(); ++k) {
      const Observable &observable = *input_.observables[k].observable;
      const std::size_t n = observable.profile_columns().size();
      if (n == 0)
        continue;
      const auto all = view_->gather(observable.profile(*view_));
      if (!files_[k].profile)
        continue;
      std::vector<std::vector<double>> lines;
      for (std::size_t i = 0; i < all.size(); i += n) {
        auto &line = lines.emplace_back(
            std::vector<double>{double(state.step), state.time});
        line.insert(line.end(), all.begin() + long(i),
                    all.begin() + long(i + n));
      }
      std::sort(lines.begin(), lines.end());
      for (const auto &line : lines)
        files_[k].profile->write(line);
    }
    view_->motion().forget();
  }

  template <int dim>
  void Observers<dim>::serialize_file(Archive &archive, const std::size_t k,
                                      const bool of_profile,
                                      std::string &failure)
  {
    const auto names = titles(k, of_profile);
    if (names.empty())
      return;
    auto &file = of_profile ? files_[k].profile : files_[k].rows;
    std::uintmax_t n_bytes = file ? file->n_bytes() : 0;
    archive.numbers(of_profile ? "profile_bytes" : "bytes", n_bytes);
    if (!archive.reads() || !communicator_.is_root())
      return;
    const std::string where = path(k, of_profile ? "_profile" : "");
    try {
      for (const auto &row : TableFile::read(where, names.size(), n_bytes))
        if (!of_profile)
          records_[k].add(row[1], {row.begin() + 2, row.end()}, true);
      file = std::make_unique<TableFile>(where, names, n_bytes);
    } catch (const std::exception &error) {
      failure = error.what();
    }
  }

  template <int dim>
  void Observers<dim>::serialize(Archive &archive)
  {
    const Archive::Part part(archive, "observables");
    std::string failure;
    for (std::size_t k = 0; k < records_.size(); ++k) {
      const Archive::Part one(archive, records_[k].name);
      serialize_file(archive, k, false, failure);
      serialize_file(archive, k, true, failure);
      archive.common("last", records_[k].last);
      input_.observables[k].observable->serialize(archive);
    }
    if (communicator_.any(!failure.empty()))
      throw BadCheckpoint(failure);
  }

  template class Observers<2>;
  template class Observers<3>;
} // namespace nsfd
