#pragma once

#include "joined/ghost_layer.h"
#include "nsfd/core/archive.h"
#include "state/state.h"

namespace nsfd
{
  /** Of the cells of this rank: with those of @p layer, vector by vector. What
      is known of them. */
  template <int dim>
  void spread_state(const GhostLayer<dim> &layer, State &state);

  /** The other ones. Collective. */
  template <int dim>
  void fetch_state(const GhostLayer<dim> &layer, State &all);

  /** Motion, histories and points of the cells of this rank alone. */
  template <int dim>
  void take_own(const GhostLayer<dim> &layer, State &state);

  /**
   * For parts that look at ghosts too: their values over bodies and points, in
   * an archive over those of the cells of this rank.
   */
  template <int dim>
  class GhostArchive final : public Archive
  {
  public:
    GhostArchive(const GhostLayer<dim> &layer, Archive &archive)
        : Archive(archive.reads()), layer_(layer), archive_(archive)
    {
    }

    void bodies(const std::string &name, std::vector<double> &values) override;
    void points(const std::string &name, std::vector<double> &values) override
    {
      store_points(name, values);
    }
    void points(const std::string &name,
                std::vector<std::uint8_t> &values) override
    {
      store_points(name, values);
    }
    void histories(const std::string &name,
                   std::vector<double> &values) override
    {
      archive_.histories(path(name), values);
    }
    void cells(const std::string &name, std::vector<double> &values) override
    {
      archive_.cells(path(name), values);
    }
    void common(const std::string &name, std::vector<double> &values) override
    {
      archive_.common(path(name), values);
    }
    void on_root(const std::string &name, std::vector<double> &values) override
    {
      archive_.on_root(path(name), values);
    }
    void on_root(const std::string &name, std::string &text) override
    {
      archive_.on_root(path(name), text);
    }

  private:
    template <typename T>
    void store_points(const std::string &name, std::vector<T> &values);

    const GhostLayer<dim> &layer_;
    Archive &archive_;
  };
} // namespace nsfd
