#include "serialize_pictures.h"

#include "nsfd/core/archive.h"

#include <array>

namespace nsfd
{
  namespace
  {
    using Place = std::array<double, 3>;

    /** Numbers in a row, one after the other, in or out. */
    class Row
    {
    public:
      Row(std::vector<double> &values, const bool reads)
          : values_(values), reads_(reads)
      {
      }

      template <typename T>
      void pass(T &number)
      {
        if (reads_)
          number = static_cast<T>(values_.at(next_++));
        else
          values_.push_back(static_cast<double>(number));
      }
      void pass(Place &place)
      {
        for (double &x : place)
          pass(x);
      }
      template <typename T>
      void pass(std::vector<T> &list)
      {
        std::size_t n = list.size();
        pass(n);
        if (reads_ && n > values_.size())
          throw BadCheckpoint("a picture in the checkpoint is damaged");
        list.resize(n);
        for (T &item : list)
          pass(item);
      }
      void pass(Snapshot::Polygon &polygon)
      {
        pass(polygon.reference);
        pass(polygon.displacement);
        pass(polygon.value);
        pass(polygon.speed);
        pass(polygon.warmth);
        pass(polygon.fragment);
        pass(polygon.material);
      }
      void pass(Snapshot::FacePiece &face)
      {
        for (Place *place :
             {&face.a, &face.b, &face.displacement_a, &face.displacement_b})
          pass(*place);
        pass(face.beta);
        pass(face.contact);
        pass(face.can_break);
      }
      void pass(Snapshot &snapshot)
      {
        pass(snapshot.time);
        pass(snapshot.dimension);
        pass(snapshot.polygons);
        pass(snapshot.faces);
      }

    private:
      std::vector<double> &values_;
      const bool reads_;
      std::size_t next_ = 0;
    };
  } // namespace

  void serialize(std::vector<Snapshot> &snapshots, Archive &archive)
  {
    const Archive::Part part(archive, "pictures");
    std::size_t n = snapshots.size();
    archive.numbers("number", n);
    snapshots.resize(n);
    for (std::size_t k = 0; k < n; ++k) {
      std::vector<double> values;
      if (!archive.reads())
        Row(values, false).pass(snapshots[k]);
      archive.on_root(std::to_string(k), values);
      if (archive.reads() && !values.empty())
        Row(values, true).pass(snapshots[k]);
    }
  }
} // namespace nsfd
